// How much of the light an interface reflects.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/math/vec.h"

namespace sightline {

/// Unpolarised reflectance of a dielectric; `cos_i` >= 0 on the near side, `eta` = far index over near index. 1 under total internal
/// reflection. `cos_t` receives the cosine on the far side (0 under total internal reflection).
inline float fresnel_dielectric(float cos_i, float eta, float& cos_t) {
  cos_i = std::clamp(cos_i, 0.f, 1.f);
  const float sin2_t = (1 - cos_i * cos_i) / (eta * eta);
  cos_t = 0;
  if (sin2_t >= 1) return 1;
  cos_t = std::sqrt(1 - sin2_t);
  const float parallel_denominator = eta * cos_i + cos_t, perpendicular_denominator = cos_i + eta * cos_t;
  if (!(parallel_denominator > 0) || !(perpendicular_denominator > 0)) return 1;
  const float parallel = (eta * cos_i - cos_t) / parallel_denominator;
  const float perpendicular = (cos_i - eta * cos_t) / perpendicular_denominator;
  return 0.5f * (parallel * parallel + perpendicular * perpendicular);
}
inline float fresnel_dielectric(float cos_i, float eta) {
  float cos_t;
  return fresnel_dielectric(cos_i, eta, cos_t);
}

/// Unpolarised reflectance of a conductor with index eta + i k over vacuum, per channel.
inline Color fresnel_conductor(float cos_i, const Color& eta, const Color& k) {
  const float c = std::clamp(cos_i, 0.f, 1.f), c2 = c * c, s2 = 1 - c2;
  const Color t0 = eta * eta - k * k - s2;
  const Color a2_plus_b2 = glm::sqrt(t0 * t0 + 4.f * eta * eta * k * k);
  const Color a = glm::sqrt(glm::max(0.5f * (a2_plus_b2 + t0), Color(0)));
  const Color sum = a2_plus_b2 + c2, twice = 2.f * c * a;
  const Color perpendicular = (sum - twice) / glm::max(sum + twice, Color(1e-20f));
  const Color sum_parallel = c2 * a2_plus_b2 + s2 * s2, twice_parallel = twice * s2;
  const Color parallel = perpendicular * (sum_parallel - twice_parallel) / glm::max(sum_parallel + twice_parallel, Color(1e-20f));
  return glm::clamp(0.5f * (perpendicular + parallel), 0.f, 1.f);
}

/// (1 - cos)^5.
inline float schlick_weight(float cos_i) {
  const float m = std::clamp(1 - cos_i, 0.f, 1.f), m2 = m * m;
  return m2 * m2 * m;
}
/// Schlick's approximation [Schlick1994].
inline Color fresnel_schlick(const Color& f0, float cos_i) { return f0 + (1.f - f0) * schlick_weight(cos_i); }

/// Mean reflectance of a smooth dielectric under uniform diffuse light from the outside, eta >= 1 (closed form of [Walsh1926]).
float fresnel_dielectric_diffuse(float eta);

/// Reflection of w about m.
inline Vec3 reflect_about(const Vec3& w, const Vec3& m) { return 2 * glm::dot(w, m) * m - w; }

}  // namespace sightline
