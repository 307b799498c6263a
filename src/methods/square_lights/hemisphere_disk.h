// The equal-area map of the hemisphere onto the unit disk in which all tables of the method are stored.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/math/vec.h"

namespace sightline::square_lights {

/// p of a unit direction in a local frame (z the normal): |p| = sqrt(1 - cos theta), so that dA = dw / 2; the hemisphere fills the unit
/// disk and the whole sphere the disk of radius sqrt(2). The first component of p belongs to y, as the paper prints it.
inline Vec2 disk_from_direction(const Vec3& w) {
  // Near -z the quotient of two small numbers is lost: |p| comes from 1 - z and the azimuth from (x, y).
  const float length2 = w.x * w.x + w.y * w.y;
  const float scale = w.z > -0.5f ? 1 / std::sqrt(1 + w.z) : std::sqrt((1 - w.z) / std::max(length2, 1e-30f));
  return {w.y * scale, w.x * scale};
}

/// The inverse; valid to |p| = sqrt(2).
inline Vec3 direction_from_disk(const Vec2& p) {
  const float s = p.x * p.x + p.y * p.y;
  const float k = std::sqrt(std::max(0.f, 2 - s));
  return {p.y * k, p.x * k, 1 - s};
}

/// r_p of a square light of half diagonal r: areas halve on the disk, so lengths shrink by sqrt(2).
/// Deviation: the paper keeps r, with which the square in the plane covers twice the light's solid angle.
inline float plane_radius(float r) { return r * 0.70710678f; }

}  // namespace sightline::square_lights
