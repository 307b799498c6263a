// Orthonormal frames around a normal.
#pragma once

#include <cmath>

#include "base/math/vec.h"

namespace sightline {

/// Right-handed orthonormal frame; local z is the normal.
struct Frame3 {
  Vec3 tangent{1, 0, 0}, bitangent{0, 1, 0}, normal{0, 0, 1};

  Vec3 to_local(const Vec3& v) const { return {glm::dot(v, tangent), glm::dot(v, bitangent), glm::dot(v, normal)}; }
  Vec3 to_world(const Vec3& v) const { return v.x * tangent + v.y * bitangent + v.z * normal; }
};

/// Branchless frame around a unit normal [Duff2017].
inline Frame3 frame_from_normal(const Vec3& n) {
  const float sign = std::copysign(1.f, n.z);
  const float a = -1.f / (sign + n.z);
  const float b = n.x * n.y * a;
  return {{1.f + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}

/// Frame around `n` whose tangent lies along the projection of `t`; falls back to [Duff2017] where `t` is parallel to `n` or zero.
inline Frame3 frame_from_normal_tangent(const Vec3& n, const Vec3& t) {
  const Vec3 projected = t - n * glm::dot(n, t);
  const float length = glm::length(projected);
  if (!(length > 1e-6f * glm::length(t)) || !std::isfinite(length)) return frame_from_normal(n);
  const Vec3 tangent = projected / length;
  return {tangent, glm::cross(n, tangent), n};
}

}  // namespace sightline
