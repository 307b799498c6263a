// Metals: a mirror or a GGX surface with complex index of refraction.
#pragma once

#include <optional>

#include "shade/bsdf_types.h"
#include "shade/ggx.h"
#include "shade/surface_lobes.h"

namespace sightline {

/// Reflects on both sides. Single scattering only: light that a second micro-facet would have returned is lost. At normal incidence a white
/// conductor keeps 99 % for alpha 0.1, 92 % for 0.25, 69 % for 0.5 and 31 % for 1.
class Conductor {
 public:
  Conductor() = default;
  Conductor(const Color& eta, const Color& k, const Color& tint, const Ggx& ggx) : eta_(eta), k_(k), tint_(tint), ggx_(ggx) {}

  BsdfEval evaluate(const Vec3& wo, const Vec3& wi, TransportMode mode = TransportMode::radiance) const;
  std::optional<BsdfSample> sample(const Vec3& wo, float u_lobe, const Vec2& u, TransportMode mode = TransportMode::radiance) const;
  DeltaLobes delta_lobes(const Vec3& wo, TransportMode mode = TransportMode::radiance) const;
  SurfaceLobes lobes(const Vec3& wo) const;
  Color albedo() const;
  bool is_delta() const { return ggx_.is_smooth(); }
  bool is_isotropic() const { return ggx_.alpha().x == ggx_.alpha().y; }
  const Color& eta() const { return eta_; }
  const Color& k() const { return k_; }
  const Color& tint() const { return tint_; }
  const Ggx& ggx() const { return ggx_; }

 private:
  BsdfSample mirror(const Vec3& wo) const;

  Color eta_{0.2f}, k_{3.9f}, tint_{1};
  Ggx ggx_;
};

}  // namespace sightline
