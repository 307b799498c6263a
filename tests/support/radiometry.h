// Irradiance in closed form.
#pragma once

#include <cmath>
#include <numbers>
#include <span>

#include "base/math/vec.h"

namespace sightline::test {

/// Irradiance at `point` with unit `normal` from a polygon of radiance 1 that lies wholly above the point's horizon: half the sum over the
/// edges of the angle they subtend, times the cosine between the normal and the plane through edge and point [Lambert1760].
inline double polygon_irradiance(const Vec3d& point, const Vec3d& normal, std::span<const Vec3d> corners) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3d a = corners[i] - point, b = corners[(i + 1) % corners.size()] - point;
    const Vec3d plane = glm::cross(a, b);
    const double length = glm::length(plane);
    if (length > 0) sum += std::atan2(length, glm::dot(a, b)) * glm::dot(plane / length, normal);
  }
  return std::fabs(sum) / 2;
}

/// Form factor between equal parallel squares of edge `size` at `distance` [Howell2021, C-11].
inline double parallel_squares(double size, double distance) {
  const double x = size / distance, s = std::sqrt(1 + x * x);
  return 2 / (std::numbers::pi * x * x) *
         (std::log(s * s / std::sqrt(1 + 2 * x * x)) + 2 * x * s * std::atan(x / s) - 2 * x * std::atan(x));
}

/// Form factor between equal squares at a right angle with a common edge [Howell2021, C-14].
inline double perpendicular_squares() {
  return (2 * std::atan(1.0) - std::numbers::sqrt2 * std::atan(1 / std::numbers::sqrt2) + 0.25 * std::log(3.0 / 4.0)) / std::numbers::pi;
}

}  // namespace sightline::test
