#include "shade/conductor.h"

#include "shade/fresnel.h"
#include "shade/reflected_sample.h"

namespace sightline {

BsdfEval Conductor::evaluate(const Vec3& wo, const Vec3& wi, TransportMode) const {
  if (ggx_.is_smooth() || !(wo.z * wi.z > 0)) return {};
  // Turned over with both directions from below, which none of the terms notices.
  const Vec3 m = normalize_or(wo + wi, Vec3(0, 0, 1));
  const float cosine = std::fabs(glm::dot(wo, m));
  const float half_distribution = 0.5f * ggx_.distribution(m);
  return {tint_ * fresnel_conductor(cosine, eta_, k_) * (half_distribution * ggx_.shadowing_over_cosine(wo, wi)),
          half_distribution * ggx_.masking_over_cosine(wo)};
}

BsdfSample Conductor::mirror(const Vec3& wo) const { return mirror_sample(wo, tint_ * fresnel_conductor(std::fabs(wo.z), eta_, k_), 1); }

DeltaLobes Conductor::delta_lobes(const Vec3& wo, TransportMode) const {
  DeltaLobes lobes;
  if (ggx_.is_smooth() && wo.z != 0) lobes.add(mirror(wo));
  return lobes;
}

std::optional<BsdfSample> Conductor::sample(const Vec3& wo, float, const Vec2& u, TransportMode) const {
  if (wo.z == 0) return std::nullopt;
  if (ggx_.is_smooth()) return mirror(wo);
  const float side = wo.z < 0 ? -1.f : 1.f;
  BsdfSample s;
  const Vec3 upper{wo.x, wo.y, side * wo.z};
  const Vec3 m = ggx_.sample_visible(upper, u);
  s.wi = reflect_about(upper, m);
  if (!(s.wi.z > 0)) return std::nullopt;
  const float masking = ggx_.masking_over_cosine(upper);
  s.pdf = 0.5f * ggx_.distribution(m) * masking;
  s.weight = tint_ * fresnel_conductor(glm::dot(upper, m), eta_, k_) * (ggx_.shadowing_over_cosine(upper, s.wi) / masking);
  s.wi.z *= side;
  return s;
}

SurfaceLobes Conductor::lobes(const Vec3& wo) const {
  SurfaceLobes lobes;
  lobes.interface = SurfaceLobes::Interface::conductor;
  lobes.has_ggx = !ggx_.is_smooth();
  lobes.wo = upper_side(wo);
  lobes.tint = tint_, lobes.eta = eta_, lobes.k = k_;
  lobes.ggx = ggx_;
  lobes.lambert_share = 0, lobes.ggx_share = 1;
  return lobes;
}

Color Conductor::albedo() const {
  // Normal incidence stands for the whole: metals change little until grazing angles.
  return glm::clamp(tint_ * fresnel_conductor(1, eta_, k_), 0.f, 1.f);
}

}  // namespace sightline
