#include "shade/metallic_roughness.h"

#include <algorithm>
#include <cmath>

#include "base/sample/warp.h"
#include "shade/fresnel.h"
#include "shade/ggx_albedo.h"
#include "shade/reflected_sample.h"

namespace sightline {

namespace {

constexpr float kDielectricF0 = 0.04f;

}  // namespace

MetallicRoughness::MetallicRoughness(const Color& base_color, float metallic, float roughness) {
  const Color base = glm::clamp(base_color, 0.f, 1.f);
  const float metal = std::clamp(metallic, 0.f, 1.f), rough = std::clamp(roughness, 0.f, 1.f);
  ggx_ = Ggx(rough * rough, rough * rough);
  f0_ = glm::mix(Color(kDielectricF0), base, metal);
  const Color mean_specular = ggx_schlick_mean_albedo(f0_, ggx_);
  diffuse_ = (1 - metal) * base / glm::max(1.f - mean_specular, Color(1e-6f));
}

Color MetallicRoughness::specular_albedo(float cos_theta) const { return ggx_schlick_albedo(f0_, cos_theta, ggx_); }

float MetallicRoughness::specular_probability(const Color& specular_albedo_o) const {
  const float specular = luminance(specular_albedo_o), diffuse = luminance((1.f - specular_albedo_o) * diffuse_);
  return specular + diffuse > 0 ? specular / (specular + diffuse) : 0.f;
}

BsdfEval MetallicRoughness::evaluate_upper(const Vec3& wo, const Vec3& wi, const Color& specular_o) const {
  BsdfEval result;
  float specular = 1;
  if (!is_black(diffuse_)) {
    specular = specular_probability(specular_o);
    const float lambert = wi.z * kInvPi;
    result = {diffuse_ * (1.f - specular_o) * (1.f - specular_albedo(wi.z)) * lambert, (1 - specular) * lambert};
  }
  if (ggx_.is_smooth()) return result;
  const Vec3 m = normalize_or(wo + wi, Vec3(0, 0, 1));
  const float half_distribution = 0.5f * ggx_.distribution(m);
  result.f_cos += fresnel_schlick(f0_, glm::dot(wo, m)) * (half_distribution * ggx_.shadowing_over_cosine(wo, wi));
  result.pdf += specular * half_distribution * ggx_.masking_over_cosine(wo);
  return result;
}

BsdfEval MetallicRoughness::evaluate(const Vec3& wo, const Vec3& wi, TransportMode) const {
  if (!(wo.z * wi.z > 0)) return {};
  return evaluate_upper(upper_side(wo), upper_side(wi), is_black(diffuse_) ? Color(0) : specular_albedo(std::fabs(wo.z)));
}

std::optional<BsdfSample> MetallicRoughness::sample(const Vec3& wo, float u_lobe, const Vec2& u, TransportMode) const {
  if (wo.z == 0) return std::nullopt;
  const Vec3 upper = upper_side(wo);
  const bool metal = is_black(diffuse_);
  // A rough metal needs no albedo: it has but one lobe.
  const Color specular_o = metal && !ggx_.is_smooth() ? Color(0) : specular_albedo(upper.z);
  const float specular = metal ? 1.f : specular_probability(specular_o);
  Vec3 wi;
  if (u_lobe < specular) {
    if (ggx_.is_smooth()) return mirror_sample(wo, specular_o / specular, specular);
    wi = reflect_about(upper, ggx_.sample_visible(upper, u));
  } else {
    wi = sample_cosine_hemisphere(u);
  }
  return reflected_sample(wo, wi, [&](const Vec3& w) { return evaluate_upper(upper, w, specular_o); });
}

DeltaLobes MetallicRoughness::delta_lobes(const Vec3& wo, TransportMode) const {
  DeltaLobes lobes;
  if (!ggx_.is_smooth() || wo.z == 0) return lobes;
  const Color reflected = specular_albedo(std::fabs(wo.z));
  if (!is_black(reflected)) lobes.add(mirror_sample(wo, reflected, is_black(diffuse_) ? 1.f : specular_probability(reflected)));
  return lobes;
}

std::optional<SurfaceLobes> MetallicRoughness::lobes(const Vec3& wo) const {
  if (ggx_.is_smooth()) return std::nullopt;
  SurfaceLobes lobes;
  lobes.interface = SurfaceLobes::Interface::schlick;
  lobes.has_ggx = true;
  lobes.wo = upper_side(wo);
  lobes.f0 = f0_;
  lobes.ggx = ggx_;
  lobes.lambert_share = 0, lobes.ggx_share = 1;
  if (!is_black(diffuse_)) {
    const Color specular_o = specular_albedo(std::fabs(wo.z));
    lobes.base = diffuse_ * (1.f - specular_o);
    lobes.ggx_share = specular_probability(specular_o), lobes.lambert_share = 1 - lobes.ggx_share;
  }
  ggx_schlick_albedo_nodes(ggx_, lobes.albedo, lobes.albedo_rest);
  return lobes;
}

Color MetallicRoughness::albedo() const {
  // Under uniform light, with E the mean albedo of the GGX part: E + (1 - E)² diffuse.
  const Color mean_specular = ggx_schlick_mean_albedo(f0_, ggx_);
  return glm::clamp(mean_specular + (1.f - mean_specular) * (1.f - mean_specular) * diffuse_, 0.f, 1.f);
}

}  // namespace sightline
