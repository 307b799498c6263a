// The contract that every BSDF keeps.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "base/math/vec.h"

namespace sightline {

/// Which quantity is transported: radiance from lights to the eye, or importance. Refraction scales radiance by 1/eta².
enum class TransportMode { radiance, importance };

/// f(wo, wi) |cos wi| and the density (solid angle) with which sample() would choose wi. Delta parts contribute nothing here.
struct BsdfEval {
  Color f_cos{0};
  float pdf = 0;
};

/// A sampled direction; `weight` = f |cos| / pdf, the exact ratio for delta parts.
struct BsdfSample {
  Vec3 wi{0, 0, 1};
  Color weight{0};
  float pdf = 0;  ///< solid angle; for delta parts the probability of having chosen them
  bool is_delta = false;
  bool is_transmission = false;
  float eta = 1;  ///< index of refraction ratio passed (far side over near side), 1 for reflection
};

/// The delta parts seen from one direction: none, one, or a reflection and a transmission, in that order. Here `weight` is all that the
/// part carries, f |cos| with Fresnel, not divided by `pdf`, the probability with which sample() chooses it.
class DeltaLobes {
 public:
  void add(const BsdfSample& lobe) { lobes_[count_++] = lobe; }
  std::size_t size() const { return count_; }
  const BsdfSample& operator[](std::size_t i) const { return lobes_[i]; }
  const BsdfSample* begin() const { return lobes_.data(); }
  const BsdfSample* end() const { return lobes_.data() + count_; }

 private:
  std::array<BsdfSample, 2> lobes_;
  std::size_t count_ = 0;
};

// A BSDF class has, in the local shading frame (z = shading normal, wo and wi point away from the surface, wo.z may be negative):
//   BsdfEval evaluate(Vec3 wo, Vec3 wi, TransportMode) const;
//   std::optional<BsdfSample> sample(Vec3 wo, float u_lobe, Vec2 u, TransportMode) const;   // u in [0,1)
//   DeltaLobes delta_lobes(Vec3 wo, TransportMode) const;                                     // none unless some limit is smooth
//   Color albedo() const;                                                                    // for the albedo AOV, in [0,1]
//   bool is_delta() const;                                                                   // no non-delta part: skip light sampling
//   bool is_isotropic() const;                                                               // the same however turned about z

}  // namespace sightline
