// Normals for vertices whose own are missing or useless.
#pragma once

#include <span>
#include <vector>

#include "base/math/vec.h"

namespace sightline {

/// Zero normals become the area-weighted mean of the triangles around their vertex.
inline void repair_normals(std::span<Vec3> normals, std::span<const Vec3> positions, std::span<const UVec3> triangles) {
  std::vector<bool> bad(normals.size());
  bool any = false;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    bad[i] = normals[i] == Vec3(0);
    any |= bad[i];
  }
  if (!any) return;
  for (const UVec3& t : triangles) {
    if (!bad[t.x] && !bad[t.y] && !bad[t.z]) continue;
    const Vec3 weighted = glm::cross(positions[t.y] - positions[t.x], positions[t.z] - positions[t.x]);
    for (int k = 0; k < 3; ++k) {
      if (bad[t[k]] && is_finite(weighted)) normals[t[k]] += weighted;
    }
  }
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (bad[i]) normals[i] = normalize_or(normals[i], Vec3(0, 1, 0));
  }
}

}  // namespace sightline
