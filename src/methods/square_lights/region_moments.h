// Moments of the light over a region's texels.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>

#include "methods/square_lights/merge_tree.h"

namespace sightline::square_lights {

/// Sets sigma_L and m_L of a node; `solid_angle(texel)` and `radiance(texel)` look up the texels.
template <class SolidAngle, class Radiance>
void set_moments(MergeNode& node, std::span<const std::uint32_t> texels, SolidAngle&& solid_angle, Radiance&& radiance) {
  double area = 0, flux = 0;
  for (const std::uint32_t t : texels) {
    area += solid_angle(t);
    flux += static_cast<double>(solid_angle(t)) * luminance(radiance(t));
  }
  const double mean = flux / area;
  double second = 0, third = 0;
  for (const std::uint32_t t : texels) {
    const double d = std::fabs(luminance(radiance(t)) - mean), weighted = solid_angle(t) * d * d;
    second += weighted;
    third += weighted * d;
  }
  node.deviation = static_cast<float>(std::sqrt(second / area));
  node.third_moment = static_cast<float>(std::cbrt(third / area));
}

}  // namespace sightline::square_lights
