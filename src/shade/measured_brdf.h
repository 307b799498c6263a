// A measured BRDF as one of the reflectance models.
#pragma once

#include <optional>

#include "shade/bsdf_types.h"
#include "shade/measured_reflectance.h"

namespace sightline {

/// Refers to the data, which the scene's material owns.
class MeasuredBrdf {
 public:
  explicit MeasuredBrdf(const MeasuredReflectance& data) : data_(&data) {}

  BsdfEval evaluate(const Vec3& wo, const Vec3& wi, TransportMode mode = TransportMode::radiance) const;
  std::optional<BsdfSample> sample(const Vec3& wo, float u_lobe, const Vec2& u, TransportMode mode = TransportMode::radiance) const;
  DeltaLobes delta_lobes(const Vec3&, TransportMode = TransportMode::radiance) const { return {}; }
  Color albedo() const { return data_->albedo(); }
  bool is_delta() const { return false; }
  bool is_isotropic() const { return true; }
  const MeasuredReflectance& data() const { return *data_; }

 private:
  const MeasuredReflectance* data_;
};

}  // namespace sightline
