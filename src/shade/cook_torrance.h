// The model of Cook and Torrance over Lambert.
#pragma once

#include <optional>

#include "shade/bsdf_types.h"

namespace sightline {

/// f = diffuse / pi + specular D F G / (4 cos_i cos_o) [CookTorrance1982, Eq. 3 and 4]: Beckmann's distribution of facets of rms slope
/// `roughness`, D = exp(-(tan/m)²) / (pi m² cos⁴); the shadowing of V-shaped grooves, G = min(1, 2 n·h n·o / o·h, 2 n·h n·i / i·h);
/// Fresnel's dielectric equation whose index per channel follows from the reflectance `f0` at normal incidence. Where diffuse + specular
/// exceeds 1 both are scaled down.
///
/// The grooves are the paper's own G. They hide exactly what their visible facets lack [Heitz2014, §5.2], so that the lobe never returns
/// more than F, and facets are sampled exactly as they are seen [HeitzDEon2014]: a sample weighs F G2 / G1. Deviation: the paper divides by
/// pi where [Walter2007, Eq. 20] has 4; only the latter keeps the energy.
class CookTorrance {
 public:
  CookTorrance() : CookTorrance(Color(0.2f), Color(0.8f), 0.3f, Color(0.04f)) {}
  /// Roughness is taken into [kLeastRoughness, 2], f0 into [0, 0.9999].
  CookTorrance(const Color& diffuse, const Color& specular, float roughness, const Color& f0);
  static constexpr float kLeastRoughness = 1e-3f;

  BsdfEval evaluate(const Vec3& wo, const Vec3& wi, TransportMode mode = TransportMode::radiance) const;
  std::optional<BsdfSample> sample(const Vec3& wo, float u_lobe, const Vec2& u, TransportMode mode = TransportMode::radiance) const;
  DeltaLobes delta_lobes(const Vec3&, TransportMode = TransportMode::radiance) const { return {}; }
  Color albedo() const { return diffuse_ + specular_ * fresnel(1); }
  bool is_delta() const { return false; }
  bool is_isotropic() const { return true; }
  const Color& diffuse() const { return diffuse_; }
  const Color& specular() const { return specular_; }
  float roughness() const { return roughness_; }
  const Color& eta() const { return eta_; }

 private:
  Color fresnel(float cosine) const;
  float specular_probability(float cos_o) const;

  Color diffuse_, specular_, eta_;
  float roughness_;
};

}  // namespace sightline
