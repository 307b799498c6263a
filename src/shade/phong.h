// The normalised modified Phong model over Lambert, for OBJ/MTL.
#pragma once

#include <optional>

#include "shade/bsdf_types.h"

namespace sightline {

/// f = diffuse / pi + specular (n + 2) / (2 pi) cos^n(angle to the mirror direction) [Lafortune1994]. Reciprocal; where diffuse + specular
/// exceeds 1 both are scaled down, which keeps the energy. The lobe loses what it would send below the surface.
class Phong {
 public:
  Phong() : Phong(Color(0.5f), Color(0), 32) {}
  Phong(const Color& diffuse, const Color& specular, float exponent);

  BsdfEval evaluate(const Vec3& wo, const Vec3& wi, TransportMode mode = TransportMode::radiance) const;
  std::optional<BsdfSample> sample(const Vec3& wo, float u_lobe, const Vec2& u, TransportMode mode = TransportMode::radiance) const;
  DeltaLobes delta_lobes(const Vec3&, TransportMode = TransportMode::radiance) const { return {}; }
  Color albedo() const { return diffuse_ + specular_; }
  bool is_delta() const { return false; }
  bool is_isotropic() const { return true; }
  const Color& diffuse() const { return diffuse_; }
  const Color& specular() const { return specular_; }

 private:
  Color diffuse_, specular_;
  float exponent_;
  float specular_probability_;
};

}  // namespace sightline
