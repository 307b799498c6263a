#include <algorithm>

#include "scene/load/load.h"

namespace sightline {
namespace {

/// No area, even before rounding: two corners coincide or all three lie on a line. Such a triangle can never be hit.
bool is_degenerate(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3d normal = glm::cross(Vec3d(b) - Vec3d(a), Vec3d(c) - Vec3d(a));
  return normal.x == 0 && normal.y == 0 && normal.z == 0;
}

}  // namespace

void drop_bad_triangles(std::span<const Vec3> positions, std::vector<UVec3>& triangles, std::vector<std::uint16_t>* triangle_materials,
                        std::uint64_t& dropped) {
  const std::size_t vertex_count = positions.size();
  const auto is_good = [&](const UVec3& t) {
    if (t.x >= vertex_count || t.y >= vertex_count || t.z >= vertex_count) return false;
    if (t.x == t.y || t.y == t.z || t.z == t.x) return false;
    const Vec3 &a = positions[t.x], &b = positions[t.y], &c = positions[t.z];
    return is_finite(a) && is_finite(b) && is_finite(c) && !is_degenerate(a, b, c);
  };
  // Keeps the order; nothing moves until the first bad one.
  std::size_t kept = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (!is_good(triangles[i])) continue;
    if (kept != i) {
      triangles[kept] = triangles[i];
      if (triangle_materials != nullptr && !triangle_materials->empty()) (*triangle_materials)[kept] = (*triangle_materials)[i];
    }
    ++kept;
  }
  dropped += triangles.size() - kept;
  triangles.resize(kept);
  if (triangle_materials != nullptr && !triangle_materials->empty()) triangle_materials->resize(kept);
}

void drop_bad_triangles(std::vector<Vec3>& positions, std::vector<UVec3>& triangles, std::vector<std::uint16_t>* triangle_materials,
                        std::uint64_t& dropped) {
  drop_bad_triangles(std::span<const Vec3>(positions), triangles, triangle_materials, dropped);
  // No triangle uses these any more; a finite value keeps boxes and Embree's buffers sane.
  const auto finite = std::find_if(positions.begin(), positions.end(), is_finite);
  const Vec3 stand_in = finite == positions.end() ? Vec3(0) : *finite;
  for (Vec3& p : positions) {
    if (!is_finite(p)) p = stand_in;
  }
}

}  // namespace sightline
