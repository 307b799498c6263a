// A region of the environment as sums from which its light, and how wrong that may be, follow.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "base/math/vec.h"
#include "methods/square_lights/square_light.h"

namespace sightline::square_lights {

/// How much each channel's error counts.
inline constexpr std::array<double, 3> kChannelWeight{0.3, 0.5, 0.2};

/// RegionSums over a region from which its light and its error follow; they add up.
struct RegionSums {
  double area = 0;
  Vec3d middle{0};              ///< of area
  glm::dvec3 flux{0}, own{0};   ///< by channel; `own` adds the spread within texels
  std::array<Vec3d, 3> moment;  ///< of flux, by channel

  RegionSums() { moment.fill(Vec3d(0)); }
  RegionSums(const Vec3& center, float solid_angle, const Color& radiance)
      : area(solid_angle), middle(area * Vec3d(center)), flux(area * glm::dvec3(radiance)), own(flux * (area / 6)) {
    for (int c = 0; c < 3; ++c) moment[static_cast<std::size_t>(c)] = flux[c] * Vec3d(center);
  }
  RegionSums& operator+=(const RegionSums& o) {
    area += o.area, middle += o.middle, flux += o.flux, own += o.own;
    for (std::size_t c = 0; c < 3; ++c) moment[c] += o.moment[c];
    return *this;
  }
  RegionSums& operator-=(const RegionSums& o) {
    area -= o.area, middle -= o.middle, flux -= o.flux, own -= o.own;
    for (std::size_t c = 0; c < 3; ++c) moment[c] -= o.moment[c];
    return *this;
  }
  friend RegionSums operator+(RegionSums a, const RegionSums& b) { return a += b; }

  Vec3d center() const {
    const Vec3d bright = 0.2126 * moment[0] + 0.7152 * moment[1] + 0.0722 * moment[2];
    const double length = glm::length(bright), plain = glm::length(middle);
    if (length > 0) return bright / length;
    return plain > 0 ? middle / plain : Vec3d(0, 0, 1);
  }
  /// Flux times mean squared distance from a centre, in the coordinates where solid angles are areas: 4 sin²(angle / 2) = 2 (1 - cos).
  double spread(int channel, const Vec3d& center) const {
    return std::max(0.0, 2 * (flux[channel] - glm::dot(moment[static_cast<std::size_t>(channel)], center))) + own[channel];
  }
  double error() const {
    const Vec3d c = center();
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += kChannelWeight[static_cast<std::size_t>(k)] * flux[k] * spread(k, c);
    return sum;
  }
  /// A square of half diagonal r has the mean squared distance r² / 3 from its centre.
  SquareLight light() const {
    const Vec3d c = center();
    const double bright = 0.2126 * flux.x + 0.7152 * flux.y + 0.0722 * flux.z;
    const double distance2 = (0.2126 * spread(0, c) + 0.7152 * spread(1, c) + 0.0722 * spread(2, c)) / bright;
    const double r2 = std::min(bright > 0 ? 3 * distance2 : area / 2, 2 * std::numbers::pi);
    return {Vec3(c), static_cast<float>(std::sqrt(r2)), Color(flux / (2 * r2))};
  }
};

}  // namespace sightline::square_lights
