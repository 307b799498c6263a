// Texture coordinates of a point on a triangle.
#pragma once

#include <array>

#include "base/core/shared_array.h"
#include "base/math/vec.h"

namespace sightline {

/// Texture coordinates of the three corners; a mesh without any maps each triangle to half the unit square, as pbrt does.
inline std::array<Vec2, 3> corner_uvs(const SharedArray<Vec2>& uvs, const UVec3& triangle) {
  if (uvs.empty()) return {Vec2{0, 0}, Vec2{1, 0}, Vec2{1, 1}};
  return {uvs[triangle.x], uvs[triangle.y], uvs[triangle.z]};
}

/// At barycentrics (u, v) of the second and third corner.
inline Vec2 interpolate_uv(const std::array<Vec2, 3>& corners, float u, float v) {
  return (1 - u - v) * corners[0] + u * corners[1] + v * corners[2];
}

}  // namespace sightline
