// The metallic-roughness model of glTF 2.0.
#pragma once

#include <optional>

#include "shade/bsdf_types.h"
#include "shade/ggx.h"
#include "shade/surface_lobes.h"

namespace sightline {

/// GGX with Schlick's Fresnel, F0 = mix(0.04, base, metallic), alpha = roughness², over Lambert (1 - metallic) base.
///
/// glTF leaves open how light is shared between the two. Weighting Lambert by 1 - F(half vector), as its sample code does, returns up to
/// twice the light at grazing angles; here it is weighted by (1 - E(wo)) (1 - E(wi)) / (1 - mean E), E being the directional albedo of
/// the GGX part [Kulla2017]: the same look, reciprocal, never more than 1.
class MetallicRoughness {
 public:
  MetallicRoughness() : MetallicRoughness(Color(1), 1, 1) {}
  MetallicRoughness(const Color& base_color, float metallic, float roughness);

  BsdfEval evaluate(const Vec3& wo, const Vec3& wi, TransportMode mode = TransportMode::radiance) const;
  std::optional<BsdfSample> sample(const Vec3& wo, float u_lobe, const Vec2& u, TransportMode mode = TransportMode::radiance) const;
  DeltaLobes delta_lobes(const Vec3& wo, TransportMode mode = TransportMode::radiance) const;
  /// None if smooth: Schlick's term is no table then.
  std::optional<SurfaceLobes> lobes(const Vec3& wo) const;
  Color albedo() const;
  /// A mirror-like metal.
  bool is_delta() const { return ggx_.is_smooth() && is_black(diffuse_); }
  bool is_isotropic() const { return true; }
  const Color& f0() const { return f0_; }
  /// (1 - metallic) base / (1 - mean E).
  const Color& diffuse() const { return diffuse_; }
  const Ggx& ggx() const { return ggx_; }

 private:
  Color specular_albedo(float cos_theta) const;
  float specular_probability(const Color& specular_albedo_o) const;
  /// Both on the upper side; `specular_o` is the albedo seen from wo.
  BsdfEval evaluate_upper(const Vec3& wo, const Vec3& wi, const Color& specular_o) const;

  Color f0_, diffuse_;
  Ggx ggx_;
};

}  // namespace sightline
