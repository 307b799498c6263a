#include "scene/load/gltf/triangles.h"

#include <algorithm>
#include <numeric>

namespace sightline::gltf {
namespace {

template <class Corner>
std::vector<UVec3> assemble(std::uint64_t mode, std::size_t vertex_count, const Corner& corner) {
  std::vector<UVec3> triangles(triangle_count(mode, vertex_count));
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    switch (mode) {
      case kTriangleStrip:
        // Every other triangle is turned, so that all face the same way [glTF2, §3.7.2].
        triangles[i] = {corner(i), corner(i + 1 + i % 2), corner(i + 2 - i % 2)};
        break;
      case kTriangleFan:
        triangles[i] = {corner(i + 1), corner(i + 2), corner(0)};
        break;
      default:
        triangles[i] = {corner(3 * i), corner(3 * i + 1), corner(3 * i + 2)};
    }
  }
  return triangles;
}

template <class T>
SharedArray<T> gather(const SharedArray<T>& source, std::span<const std::uint32_t> kept) {
  if (source.empty()) return {};
  return SharedArray<T>::make(kept.size(), [&](std::span<T> target) {
    for (std::size_t i = 0; i < kept.size(); ++i) target[i] = source[kept[i]];
  });
}

}  // namespace

std::size_t triangle_count(std::uint64_t mode, std::size_t vertex_count) {
  if (mode == kTriangles) return vertex_count / 3;
  return vertex_count < 3 ? 0 : vertex_count - 2;
}

std::vector<UVec3> assemble_triangles(std::uint64_t mode, std::span<const std::uint32_t> indices) {
  return assemble(mode, indices.size(), [&](std::size_t i) { return indices[i]; });
}

std::vector<UVec3> assemble_triangles(std::uint64_t mode, std::size_t vertex_count) {
  return assemble(mode, vertex_count, [](std::size_t i) { return static_cast<std::uint32_t>(i); });
}

bool uses_few_vertices(const Mesh& mesh) {
  // At most three vertices a triangle; below half, a copy is worth it. The test must not cost a pass over the shared vertices.
  return 3 * mesh.triangles.size() < mesh.positions.size() / 2;
}

std::vector<std::uint32_t> drop_unused_vertices(Mesh& mesh) {
  std::vector<std::uint32_t> kept;
  kept.reserve(3 * mesh.triangles.size());
  for (const UVec3& t : mesh.triangles) kept.insert(kept.end(), {t.x, t.y, t.z});
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());

  const auto new_index = [&](std::uint32_t old) {
    return static_cast<std::uint32_t>(std::lower_bound(kept.begin(), kept.end(), old) - kept.begin());
  };
  const SharedArray<UVec3> old_triangles = mesh.triangles;
  mesh.triangles = SharedArray<UVec3>::make(old_triangles.size(), [&](std::span<UVec3> target) {
    for (std::size_t i = 0; i < target.size(); ++i) {
      const UVec3& t = old_triangles[i];
      target[i] = {new_index(t.x), new_index(t.y), new_index(t.z)};
    }
  });
  mesh.positions = gather(mesh.positions, kept);
  mesh.normals = gather(mesh.normals, kept);
  mesh.uvs = gather(mesh.uvs, kept);
  mesh.tangents = gather(mesh.tangents, kept);
  return kept;
}

void repair_normals(Mesh& mesh) {
  std::vector<Vec3> sums(mesh.normals.size(), Vec3(0));
  for (const UVec3& t : mesh.triangles) {
    const Vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
    const Vec3 area_normal = glm::cross(b - a, c - a);
    for (int corner = 0; corner < 3; ++corner) sums[t[corner]] += area_normal;
  }
  const SharedArray<Vec3> old_normals = mesh.normals;
  mesh.normals = SharedArray<Vec3>::make(old_normals.size(), [&](std::span<Vec3> target) {
    for (std::size_t i = 0; i < target.size(); ++i) {
      target[i] = length_squared(old_normals[i]) > 0 ? old_normals[i] : normalize_or(sums[i], Vec3(0, 0, 1));
    }
  });
}

}  // namespace sightline::gltf
