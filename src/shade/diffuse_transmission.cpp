#include "shade/diffuse_transmission.h"

#include <cmath>

#include "base/sample/warp.h"

namespace sightline {

DiffuseTransmission::DiffuseTransmission(const Color& reflectance, const Color& transmittance)
    : reflectance_(glm::max(reflectance, 0.f)), transmittance_(glm::max(transmittance, 0.f)) {
  const Color scale = 1.f / glm::max(reflectance_ + transmittance_, Color(1));
  reflectance_ *= scale;
  transmittance_ *= scale;
  const float reflected = max_component(reflectance_), transmitted = max_component(transmittance_);
  reflect_probability_ = reflected + transmitted > 0 ? reflected / (reflected + transmitted) : 1;
}

BsdfEval DiffuseTransmission::evaluate(const Vec3& wo, const Vec3& wi, TransportMode) const {
  if (wo.z == 0 || wi.z == 0) return {};
  const float lambert = std::fabs(wi.z) * kInvPi;
  const bool reflects = (wo.z > 0) == (wi.z > 0);
  return {(reflects ? reflectance_ : transmittance_) * lambert, (reflects ? reflect_probability_ : 1 - reflect_probability_) * lambert};
}

std::optional<BsdfSample> DiffuseTransmission::sample(const Vec3& wo, float u_lobe, const Vec2& u, TransportMode) const {
  BsdfSample s;
  s.wi = sample_cosine_hemisphere(u);
  const bool reflects = u_lobe < reflect_probability_;
  const float probability = reflects ? reflect_probability_ : 1 - reflect_probability_;
  s.pdf = probability * s.wi.z * kInvPi;
  if (!(s.pdf > 0) || wo.z == 0) return std::nullopt;
  s.weight = (reflects ? reflectance_ : transmittance_) / probability;
  s.is_transmission = !reflects;
  if (reflects == (wo.z < 0)) s.wi.z = -s.wi.z;
  return s;
}

}  // namespace sightline
