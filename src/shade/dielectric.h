// Glass, water, and thin panes.
#pragma once

#include <optional>

#include "shade/bsdf_types.h"
#include "shade/ggx.h"

namespace sightline {

/// Interface between the outside (+z) and the inside (-z) with index ratio eta = inside over outside: smooth (delta) or GGX [Walter2007].
/// Single scattering only: glass of index 1.5 keeps at normal incidence 99 % from outside and 93 % from inside for alpha 0.25, 97 % and 75
/// % for 0.5. A thin one is a smooth slab whose two faces are one: light goes straight on, reflectance sums all its inner reflections.
class Dielectric {
 public:
  Dielectric() : Dielectric(1.5f, Ggx(), false) {}
  Dielectric(float eta, const Ggx& ggx, bool thin);

  BsdfEval evaluate(const Vec3& wo, const Vec3& wi, TransportMode mode = TransportMode::radiance) const;
  std::optional<BsdfSample> sample(const Vec3& wo, float u_lobe, const Vec2& u, TransportMode mode = TransportMode::radiance) const;
  DeltaLobes delta_lobes(const Vec3& wo, TransportMode mode = TransportMode::radiance) const;
  Color albedo() const { return Color(1); }
  bool is_delta() const { return delta_; }
  bool is_isotropic() const { return ggx_.alpha().x == ggx_.alpha().y; }

 private:
  std::optional<BsdfSample> sample_smooth(const Vec3& wo, float u_lobe, TransportMode mode) const;

  float eta_;
  Ggx ggx_;
  bool thin_;
  bool delta_;
};

}  // namespace sightline
