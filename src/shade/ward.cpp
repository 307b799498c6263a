#include "shade/ward.h"

#include <algorithm>
#include <cmath>

#include "base/sample/warp.h"
#include "shade/reflected_sample.h"

namespace sightline {

Ward::Ward(const Color& diffuse, const Color& specular, float alpha_x, float alpha_y)
    : diffuse_(glm::max(diffuse, 0.f)),
      specular_(glm::max(specular, 0.f)),
      alpha_(std::clamp(alpha_x, kLeastSlope, 2.f), std::clamp(alpha_y, kLeastSlope, 2.f)) {
  const Color scale = 1.f / glm::max(diffuse_ + specular_, Color(1));
  diffuse_ *= scale;
  specular_ *= scale;
  const float d = luminance(diffuse_), s = luminance(specular_);
  specular_probability_ = d + s > 0 ? s / (d + s) : 0;
}

BsdfEval Ward::evaluate(const Vec3& wo, const Vec3& wi, TransportMode) const {
  if (!(wo.z * wi.z > 0)) return {};
  const float cosine = std::fabs(wi.z);
  BsdfEval result{diffuse_ * (cosine * kInvPi), (1 - specular_probability_) * cosine * kInvPi};
  if (!(specular_probability_ > 0)) return result;
  const Vec3 h = wo + wi;
  const float z = std::fabs(h.z), squared = glm::dot(h, h);
  const float slope_x = h.x / (alpha_.x * z), slope_y = h.y / (alpha_.y * z);
  // The density of slopes is a Gaussian; that of half vectors has dslope = domega_h / cos³, that of directions 1 / (4 wi·h) more, which in
  // terms of the unnormalised half vector is (h·h) / (2 hz³).
  const float gaussian = std::exp(-(slope_x * slope_x + slope_y * slope_y)) * kInvPi / (alpha_.x * alpha_.y);
  const float density = gaussian * squared / (2 * z * z * z);
  if (!(density > 0) || !std::isfinite(density)) return result;
  result.f_cos += specular_ * (density * 2 * cosine / z);
  result.pdf += specular_probability_ * density;
  return result;
}

std::optional<BsdfSample> Ward::sample(const Vec3& wo, float u_lobe, const Vec2& u, TransportMode mode) const {
  if (wo.z == 0) return std::nullopt;
  const Vec3 upper = upper_side(wo);
  Vec3 wi;
  if (u_lobe < specular_probability_) {
    // A Gaussian slope, by Box and Muller; its half vector reflects wo.
    const float radius = std::sqrt(-std::log(1 - u.x)), phi = 2 * kPi * u.y;
    const Vec3 h = glm::normalize(Vec3(alpha_.x * radius * std::cos(phi), alpha_.y * radius * std::sin(phi), 1));
    wi = 2 * glm::dot(upper, h) * h - upper;
  } else {
    wi = sample_cosine_hemisphere(u);
  }
  return reflected_sample(wo, wi, [&](const Vec3& w) { return evaluate(upper, w, mode); });
}

}  // namespace sightline
