#include "scene/load/pbrt/geometry.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "scene/load/load.h"
#include "scene/load/pbrt/transform.h"

namespace sightline::pbrt {
namespace {

/// Gives vertices without a usable normal that of a face they belong to.
void mend_normals(const std::vector<Vec3>& positions, const std::vector<UVec3>& triangles, std::vector<Vec3>& normals) {
  std::vector<bool> bad(normals.size());
  bool any = false;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Vec3 unit = normalize_or(normals[i], Vec3(0));
    bad[i] = unit == Vec3(0);
    any = any || bad[i];
    normals[i] = unit;
  }
  if (!any) return;
  for (const UVec3& t : triangles) {
    const Vec3 face = normalize_or(glm::cross(positions[t.y] - positions[t.x], positions[t.z] - positions[t.x]), Vec3(0, 0, 1));
    for (int corner = 0; corner < 3; ++corner) {
      if (bad[t[corner]]) normals[t[corner]] = face;
    }
  }
  for (Vec3& n : normals) {
    if (n == Vec3(0)) n = Vec3(0, 0, 1);
  }
}

void transform(MeshArrays& arrays, const Mat4d& world_from_object, bool reverse_orientation) {
  if (!is_identity(world_from_object)) {
    for (Vec3& p : arrays.positions) p = Vec3(Vec3d(world_from_object * glm::dvec4(Vec3d(p), 1)));
    // Normals go with the inverse transpose: the cofactors over the determinant, of which only the sign matters.
    const Mat3d m(world_from_object);
    const double sign = determinant(world_from_object) < 0 ? -1 : 1;
    const Mat3d cofactors = sign * Mat3d(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
    for (Vec3& n : arrays.normals) n = Vec3(cofactors * Vec3d(n));
  }
  if (reverse_orientation) {
    for (Vec3& n : arrays.normals) n = -n;
  }
}

/// Whether a triangle must be turned round: its shading normals decide, else `flip`.
bool is_turned(const UVec3& t, std::span<const Vec3> positions, std::span<const Vec3> normals, bool flip) {
  if (normals.empty()) return flip;
  const Vec3 face = glm::cross(positions[t.y] - positions[t.x], positions[t.z] - positions[t.x]);
  const float side = glm::dot(face, normals[t.x] + normals[t.y] + normals[t.z]);
  return side != 0 ? side < 0 : flip;
}

Mesh to_mesh(const MeshArrays& arrays) {
  Mesh mesh;
  mesh.positions = arrays.positions;
  mesh.normals = arrays.normals;
  mesh.uvs = arrays.uvs;
  mesh.triangles = arrays.triangles;
  for (const Vec3& p : arrays.positions) mesh.bounds.add(p);
  return mesh;
}

}  // namespace

Mesh bake(MeshArrays arrays, const Mat4d& world_from_object, bool reverse_orientation, std::uint64_t& dropped) {
  transform(arrays, world_from_object, reverse_orientation);
  if (arrays.normals.size() != arrays.positions.size()) arrays.normals.clear();
  if (arrays.uvs.size() != arrays.positions.size()) arrays.uvs.clear();
  drop_bad_triangles(arrays.positions, arrays.triangles, nullptr, dropped);
  if (!arrays.normals.empty()) mend_normals(arrays.positions, arrays.triangles, arrays.normals);
  const bool flip = reverse_orientation != (determinant(world_from_object) < 0);
  for (UVec3& t : arrays.triangles) {
    if (is_turned(t, arrays.positions, arrays.normals, flip)) std::swap(t.y, t.z);
  }
  for (Vec2& uv : arrays.uvs) uv.y = 1 - uv.y;
  return to_mesh(arrays);
}

Mesh bake(const Mesh& mesh, const Mat4d& world_from_object, bool reverse_orientation) {
  const bool flip = reverse_orientation != (determinant(world_from_object) < 0);
  if (is_identity(world_from_object) && !reverse_orientation) {
    const auto is_wrong = [&](const UVec3& t) { return is_turned(t, mesh.positions.span(), mesh.normals.span(), flip); };
    if (std::none_of(mesh.triangles.begin(), mesh.triangles.end(), is_wrong)) return mesh;
  }
  MeshArrays arrays{{mesh.positions.begin(), mesh.positions.end()},
                    {mesh.normals.begin(), mesh.normals.end()},
                    {mesh.uvs.begin(), mesh.uvs.end()},
                    {mesh.triangles.begin(), mesh.triangles.end()}};
  transform(arrays, world_from_object, reverse_orientation);
  if (!arrays.normals.empty()) mend_normals(arrays.positions, arrays.triangles, arrays.normals);
  for (UVec3& t : arrays.triangles) {
    if (is_turned(t, arrays.positions, arrays.normals, flip)) std::swap(t.y, t.z);
  }
  return to_mesh(arrays);
}

AreaStatistics triangle_areas(const Mesh& mesh, const Mat4d& world_from_object) {
  AreaStatistics result;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const UVec3& t = mesh.triangles[i];
    const Vec3d a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
    const Mat3d linear(world_from_object);
    const double area = 0.5 * glm::length(glm::cross(linear * (b - a), linear * (c - a)));
    result.total += area;
    result.smallest = i == 0 ? area : std::min(result.smallest, area);
    result.largest = std::max(result.largest, area);
  }
  return result;
}

}  // namespace sightline::pbrt
