// Axis-aligned boxes.
#pragma once

#include <limits>

#include "base/math/vec.h"

namespace sightline {

/// Axis-aligned box; empty (lower > upper) until something is added.
struct Bounds {
  Vec3 lower{std::numeric_limits<float>::infinity()};
  Vec3 upper{-std::numeric_limits<float>::infinity()};

  void add(const Vec3& p) {
    lower = glm::min(lower, p);
    upper = glm::max(upper, p);
  }
  void add(const Bounds& b) {
    lower = glm::min(lower, b.lower);
    upper = glm::max(upper, b.upper);
  }
  bool is_empty() const { return !(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z); }
  Vec3 center() const { return 0.5f * lower + 0.5f * upper; }
  Vec3 extent() const { return upper - lower; }
  float half_diagonal() const { return is_empty() ? 0.f : 0.5f * glm::length(extent()); }
};

/// Box of the eight transformed corners.
inline Bounds transform_bounds(const Mat4& m, const Bounds& b) {
  Bounds result;
  if (b.is_empty()) return result;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p{corner & 1 ? b.upper.x : b.lower.x, corner & 2 ? b.upper.y : b.lower.y, corner & 4 ? b.upper.z : b.lower.z};
    result.add(transform_point(m, p));
  }
  return result;
}

}  // namespace sightline
