// Ideal diffuse reflection, on both sides.
#pragma once

#include <cmath>
#include <optional>

#include "base/sample/warp.h"
#include "shade/bsdf_types.h"
#include "shade/surface_lobes.h"

namespace sightline {

/// f = reflectance / pi.
struct Lambert {
  Color reflectance{0.7f};

  BsdfEval evaluate(const Vec3& wo, const Vec3& wi, TransportMode = TransportMode::radiance) const {
    if (!(wo.z * wi.z > 0)) return {};
    const float pdf = std::fabs(wi.z) * kInvPi;
    return {reflectance * pdf, pdf};
  }
  std::optional<BsdfSample> sample(const Vec3& wo, float, const Vec2& u, TransportMode = TransportMode::radiance) const {
    BsdfSample s;
    s.wi = sample_cosine_hemisphere(u);
    s.pdf = s.wi.z * kInvPi;
    if (!(s.pdf > 0) || wo.z == 0) return std::nullopt;
    if (wo.z < 0) s.wi.z = -s.wi.z;
    s.weight = reflectance;
    return s;
  }
  SurfaceLobes lobes(const Vec3& wo) const {
    SurfaceLobes lobes;
    lobes.wo = {wo.x, wo.y, std::fabs(wo.z)};
    lobes.base = reflectance;
    return lobes;
  }
  DeltaLobes delta_lobes(const Vec3&, TransportMode = TransportMode::radiance) const { return {}; }
  Color albedo() const { return glm::clamp(reflectance, 0.f, 1.f); }
  bool is_delta() const { return false; }
  bool is_isotropic() const { return true; }
};

}  // namespace sightline
