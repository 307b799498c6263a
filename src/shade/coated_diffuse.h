// Plastic, varnish, ceramics: Lambert below a dielectric coat, as one analytic model.
#pragma once

#include <optional>

#include "shade/bsdf_types.h"
#include "shade/ggx.h"
#include "shade/surface_lobes.h"

namespace sightline {

/// f = GGX reflection of the coat (a delta if it is smooth) + T(wo) T(wi) reflectance / (pi eta² (1 - reflectance Ri)), where T is what the
/// coat lets in and Ri its mean reflectance seen from below: all bounces between base and coat, summed [Wolff1998]. Reciprocal, and it
/// returns all energy for reflectance 1. `evaluate` of a smooth coat covers the diffuse part only.
class CoatedDiffuse {
 public:
  CoatedDiffuse() : CoatedDiffuse(Color(0.5f), 1.5f, Ggx()) {}
  /// `eta` is taken into [1, 3]: a coat lighter than air makes no sense, and none is denser than that.
  CoatedDiffuse(const Color& reflectance, float eta, const Ggx& ggx);

  BsdfEval evaluate(const Vec3& wo, const Vec3& wi, TransportMode mode = TransportMode::radiance) const;
  std::optional<BsdfSample> sample(const Vec3& wo, float u_lobe, const Vec2& u, TransportMode mode = TransportMode::radiance) const;
  DeltaLobes delta_lobes(const Vec3& wo, TransportMode mode = TransportMode::radiance) const;
  SurfaceLobes lobes(const Vec3& wo) const;
  /// Remembers what the coat reflects of unit `w`: for a direction that many evaluations share.
  void prepare(const Vec3& w);
  Color albedo() const;
  bool is_delta() const { return false; }
  bool is_isotropic() const { return ggx_.alpha().x == ggx_.alpha().y; }

 private:
  float coat_reflectance(float cos_theta) const;
  float specular_probability(float coat_reflectance_o) const;
  /// Both on the upper side; `reflected_o` is what the coat reflects of wo.
  BsdfEval evaluate_upper(const Vec3& wo, const Vec3& wi, float reflected_o) const;

  Color base_;  // reflectance / (eta² (1 - reflectance Ri))
  float eta_;
  float mean_transmittance_;  // of the coat from outside
  Ggx ggx_;
  float known_cosine_ = -1, known_reflectance_ = 0;  // of prepare()
};

}  // namespace sightline
