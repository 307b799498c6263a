#include "shade/measured_brdf.h"

#include <cmath>

namespace sightline {

BsdfEval MeasuredBrdf::evaluate(const Vec3& wo, const Vec3& wi, TransportMode) const {
  if (!(wo.z * wi.z > 0)) return {};
  const Vec3 o{wo.x, wo.y, std::fabs(wo.z)}, i{wi.x, wi.y, std::fabs(wi.z)};
  return {data_->value(o, i) * i.z, data_->pdf(o, i)};
}

std::optional<BsdfSample> MeasuredBrdf::sample(const Vec3& wo, float u_lobe, const Vec2& u, TransportMode mode) const {
  if (wo.z == 0) return std::nullopt;
  const Vec3 upper{wo.x, wo.y, std::fabs(wo.z)};
  BsdfSample s;
  s.wi = data_->sample(upper, u_lobe, u);
  const BsdfEval e = evaluate(upper, s.wi, mode);
  if (!(e.pdf > 0)) return std::nullopt;
  s.pdf = e.pdf;
  s.weight = e.f_cos / e.pdf;
  if (wo.z < 0) s.wi.z = -s.wi.z;
  return s;
}

}  // namespace sightline
