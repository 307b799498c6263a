// What Eq. 13 has to know of a function over a region.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

namespace sightline::square_lights {

/// Mean, root mean square deviation, and third root of the mean cubed absolute deviation of a function over a region.
struct Moments {
  float mean = 0, deviation = 0, third = 0;
};

/// Moments of samples of equal weight.
Moments moments_of(std::span<const float> values);

/// Of a function that is 1 on a part `covered` of the region and else 0: visibility, exactly.
inline Moments binary_moments(float covered) {
  const float variance = covered * (1 - covered);
  return {covered, std::sqrt(variance), std::cbrt(variance * (covered * covered + (1 - covered) * (1 - covered)))};
}

/// Most that the mean of a product may differ from the product of the means (Eq. 13): with f = mean + deviation for each, Cauchy-Schwarz
/// bounds the terms with two deviations and Hölder (exponents 3, 3, 3) that with three.
/// Deviation: the paper prints the third moment with its sign, for which the bound fails (a symmetric function has none); it has to be the
/// absolute one.
inline float product_bound(const Moments& a, const Moments& b, const Moments& c) {
  return std::fabs(a.mean) * b.deviation * c.deviation + std::fabs(b.mean) * a.deviation * c.deviation +
         std::fabs(c.mean) * a.deviation * b.deviation + a.third * b.third * c.third;
}

/// The same where `binary` is of a function that is 0 or 1, which deviates at most by max(mean, 1 - mean): third moments are not needed.
inline float product_bound_binary(const Moments& a, const Moments& b, const Moments& binary) {
  const float most = std::max(binary.mean, 1 - binary.mean);
  return std::fabs(a.mean) * b.deviation * binary.deviation + std::fabs(b.mean) * a.deviation * binary.deviation +
         (std::fabs(binary.mean) + most) * a.deviation * b.deviation;
}

}  // namespace sightline::square_lights
