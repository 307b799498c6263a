// Ideal diffuse reflection and transmission: leaves, paper, curtains.
#pragma once

#include <optional>

#include "shade/bsdf_types.h"

namespace sightline {

/// f = reflectance / pi on the side of wo and transmittance / pi on the other. Where the two add up to more than 1 both are scaled down.
class DiffuseTransmission {
 public:
  DiffuseTransmission() : DiffuseTransmission(Color(0.25f), Color(0.25f)) {}
  DiffuseTransmission(const Color& reflectance, const Color& transmittance);

  BsdfEval evaluate(const Vec3& wo, const Vec3& wi, TransportMode mode = TransportMode::radiance) const;
  std::optional<BsdfSample> sample(const Vec3& wo, float u_lobe, const Vec2& u, TransportMode mode = TransportMode::radiance) const;
  DeltaLobes delta_lobes(const Vec3&, TransportMode = TransportMode::radiance) const { return {}; }
  Color albedo() const { return reflectance_ + transmittance_; }
  bool is_delta() const { return false; }
  bool is_isotropic() const { return true; }

 private:
  Color reflectance_, transmittance_;
  float reflect_probability_;
};

}  // namespace sightline
