#include "shade/coated_diffuse.h"

#include <algorithm>
#include <cmath>

#include "base/sample/warp.h"
#include "shade/fresnel.h"
#include "shade/ggx_albedo.h"
#include "shade/reflected_sample.h"

namespace sightline {

CoatedDiffuse::CoatedDiffuse(const Color& reflectance, float eta, const Ggx& ggx)
    : eta_(eta > 1 ? std::min(eta, kGgxAlbedoMaxEta) : 1.f), ggx_(ggx) {
  const float mean_reflectance = ggx_.is_smooth() ? fresnel_dielectric_diffuse(eta_) : ggx_dielectric_mean_albedo(ggx_, eta_);
  mean_transmittance_ = 1 - mean_reflectance;
  // Reciprocity ties what is let out to what is let in: eta² (1 - Ri) = 1 - Re.
  const Color rho = glm::clamp(reflectance, 0.f, 1.f);
  base_ = rho / (eta_ * eta_ * (1.f - rho) + rho * mean_transmittance_);
}

void CoatedDiffuse::prepare(const Vec3& w) {
  known_reflectance_ = coat_reflectance(std::fabs(w.z));
  known_cosine_ = std::fabs(w.z);
}

float CoatedDiffuse::coat_reflectance(float cos_theta) const {
  if (cos_theta == known_cosine_) return known_reflectance_;
  return ggx_.is_smooth() ? fresnel_dielectric(cos_theta, eta_) : ggx_dielectric_albedo(cos_theta, ggx_, eta_);
}

float CoatedDiffuse::specular_probability(float coat_reflectance_o) const {
  const float diffuse = (1 - coat_reflectance_o) * mean_transmittance_ * luminance(base_);
  const float total = coat_reflectance_o + diffuse;
  return total > 0 ? coat_reflectance_o / total : 0.f;
}

BsdfEval CoatedDiffuse::evaluate_upper(const Vec3& wo, const Vec3& wi, float reflected_o) const {
  const float specular = specular_probability(reflected_o);
  const float lambert = wi.z * kInvPi;
  BsdfEval result{base_ * ((1 - reflected_o) * (1 - coat_reflectance(wi.z)) * lambert), (1 - specular) * lambert};
  if (ggx_.is_smooth()) return result;
  const Vec3 m = normalize_or(wo + wi, Vec3(0, 0, 1));
  const float half_distribution = 0.5f * ggx_.distribution(m);
  result.f_cos += Color(fresnel_dielectric(glm::dot(wo, m), eta_) * half_distribution * ggx_.shadowing_over_cosine(wo, wi));
  result.pdf += specular * half_distribution * ggx_.masking_over_cosine(wo);
  return result;
}

BsdfEval CoatedDiffuse::evaluate(const Vec3& wo, const Vec3& wi, TransportMode) const {
  if (!(wo.z * wi.z > 0)) return {};
  return evaluate_upper(upper_side(wo), upper_side(wi), coat_reflectance(std::fabs(wo.z)));
}

std::optional<BsdfSample> CoatedDiffuse::sample(const Vec3& wo, float u_lobe, const Vec2& u, TransportMode) const {
  if (wo.z == 0) return std::nullopt;
  const Vec3 upper = upper_side(wo);
  const float reflected_o = coat_reflectance(upper.z);
  const float specular = specular_probability(reflected_o);
  Vec3 wi;
  if (u_lobe < specular) {
    if (ggx_.is_smooth()) return mirror_sample(wo, Color(reflected_o / specular), specular);
    wi = reflect_about(upper, ggx_.sample_visible(upper, u));
  } else {
    wi = sample_cosine_hemisphere(u);
  }
  return reflected_sample(wo, wi, [&](const Vec3& w) { return evaluate_upper(upper, w, reflected_o); });
}

DeltaLobes CoatedDiffuse::delta_lobes(const Vec3& wo, TransportMode) const {
  DeltaLobes lobes;
  if (!ggx_.is_smooth() || wo.z == 0) return lobes;
  const float reflected_o = coat_reflectance(std::fabs(wo.z));
  if (!(reflected_o > 0)) return lobes;
  lobes.add(mirror_sample(wo, Color(reflected_o), specular_probability(reflected_o)));
  return lobes;
}

SurfaceLobes CoatedDiffuse::lobes(const Vec3& wo) const {
  const float reflected_o = coat_reflectance(std::fabs(wo.z)), specular = specular_probability(reflected_o);
  SurfaceLobes lobes;
  lobes.interface = SurfaceLobes::Interface::dielectric;
  lobes.has_ggx = !ggx_.is_smooth();
  lobes.wo = upper_side(wo);
  lobes.base = base_ * (1 - reflected_o);
  lobes.eta = Color(eta_);
  lobes.ggx = ggx_;
  lobes.lambert_share = 1 - specular, lobes.ggx_share = specular;
  if (lobes.has_ggx)
    lobes.albedo = ggx_dielectric_albedo_nodes(ggx_, eta_);
  else
    lobes.albedo.fill(1);
  return lobes;
}

Color CoatedDiffuse::albedo() const {
  // Under uniform light: the mean reflectance of the coat and what comes back through it.
  return glm::clamp(Color(1 - mean_transmittance_) + base_ * (mean_transmittance_ * mean_transmittance_), 0.f, 1.f);
}

}  // namespace sightline
