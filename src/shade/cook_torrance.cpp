#include "shade/cook_torrance.h"

#include <algorithm>
#include <cmath>

#include "base/sample/warp.h"
#include "shade/fresnel.h"
#include "shade/reflected_sample.h"

namespace sightline {

CookTorrance::CookTorrance(const Color& diffuse, const Color& specular, float roughness, const Color& f0)
    : diffuse_(glm::max(diffuse, 0.f)), specular_(glm::max(specular, 0.f)), roughness_(std::clamp(roughness, kLeastRoughness, 2.f)) {
  const Color scale = 1.f / glm::max(diffuse_ + specular_, Color(1));
  diffuse_ *= scale;
  specular_ *= scale;
  // F0 = ((eta - 1) / (eta + 1))² [CookTorrance1982, Appendix].
  const Color root = glm::sqrt(glm::clamp(f0, 0.f, 0.9999f));
  eta_ = (1.f + root) / (1.f - root);
}

Color CookTorrance::fresnel(float cosine) const {
  return {fresnel_dielectric(cosine, eta_.x), fresnel_dielectric(cosine, eta_.y), fresnel_dielectric(cosine, eta_.z)};
}

float CookTorrance::specular_probability(float cos_o) const {
  const float d = luminance(diffuse_), s = luminance(specular_ * fresnel(cos_o));
  return d + s > 0 ? s / (d + s) : 0;
}

BsdfEval CookTorrance::evaluate(const Vec3& wo, const Vec3& wi, TransportMode) const {
  if (!(wo.z * wi.z > 0)) return {};
  const float cos_o = std::fabs(wo.z), cos_i = std::fabs(wi.z);
  const float specular = specular_probability(cos_o);
  BsdfEval result{diffuse_ * (cos_i * kInvPi), (1 - specular) * cos_i * kInvPi};
  if (!(specular > 0)) return result;
  Vec3 h = normalize_or(wo + wi, Vec3(0, 0, wo.z));
  h.z = std::fabs(h.z);
  const float cos2_h = h.z * h.z, cos_oh = 0.5f * glm::length(wo + wi);
  const float slope = std::max(0.f, 1 - cos2_h) / (roughness_ * roughness_ * cos2_h);
  const float distribution = std::exp(-slope) * kInvPi / (roughness_ * roughness_ * cos2_h * cos2_h);
  if (!(distribution > 0) || !std::isfinite(distribution) || !(cos_oh > 0)) return result;
  // The visible facets as a density of reflected directions: D G1(wo) (wo·h) / cos_o / (4 wo·h).
  const float groove = 2 * h.z / cos_oh;
  const float visible = distribution * std::min(1 / cos_o, groove) * 0.25f;
  result.f_cos += specular_ * fresnel(cos_oh) * (0.25f * distribution * std::min({1 / cos_o, groove, groove * cos_i / cos_o}));
  result.pdf += specular * visible;
  return result;
}

std::optional<BsdfSample> CookTorrance::sample(const Vec3& wo, float u_lobe, const Vec2& u, TransportMode mode) const {
  if (wo.z == 0) return std::nullopt;
  const Vec3 upper = upper_side(wo);
  const float specular = specular_probability(upper.z);
  Vec3 wi;
  if (u_lobe < specular) {
    // One wall of a groove by Beckmann's slopes, then the wall opposite in proportion to what is seen of either [HeitzDEon2014, Alg. 2].
    const float radius = roughness_ * std::sqrt(-std::log(1 - u.x)), phi = 2 * kPi * u.y;
    Vec3 h = glm::normalize(Vec3(radius * std::cos(phi), radius * std::sin(phi), 1));
    const float seen = std::max(0.f, glm::dot(upper, h)), opposite = std::max(0.f, glm::dot(upper, Vec3(-h.x, -h.y, h.z)));
    if (u_lobe * (seen + opposite) >= specular * seen) h = Vec3(-h.x, -h.y, h.z);
    wi = reflect_about(upper, h);
  } else {
    wi = sample_cosine_hemisphere(u);
  }
  return reflected_sample(wo, wi, [&](const Vec3& w) { return evaluate(upper, w, mode); });
}

}  // namespace sightline
