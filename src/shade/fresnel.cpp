#include "shade/fresnel.h"

namespace sightline {

float fresnel_dielectric_diffuse(float eta) {
  if (!(eta > 1)) return 0;
  // The closed form subtracts large terms near 1; there the reflectance grows linearly from nothing, and below this bound it is under 0.6
  // %.
  constexpr float kSeriesBound = 1.002f;
  if (eta < kSeriesBound) return (eta - 1) / (kSeriesBound - 1) * fresnel_dielectric_diffuse(kSeriesBound);
  const double n = eta, n2 = n * n, n4 = n2 * n2;
  const double a = (n - 1) * (3 * n + 1) / (6 * (n + 1) * (n + 1));
  const double b = n2 * (n2 - 1) * (n2 - 1) / ((n2 + 1) * (n2 + 1) * (n2 + 1)) * std::log((n - 1) / (n + 1));
  const double c = 2 * n2 * n * (n2 + 2 * n - 1) / ((n2 + 1) * (n4 - 1));
  const double d = 8 * n4 * (n4 + 1) / ((n2 + 1) * (n4 - 1) * (n4 - 1)) * std::log(n);
  return static_cast<float>(std::clamp(0.5 + a + b - c + d, 0.0, 1.0));
}

}  // namespace sightline
