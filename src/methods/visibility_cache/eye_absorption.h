// What media between eye points and lights absorb of the light that arrives.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "methods/media.h"
#include "methods/visibility_cache/eye_lanes.h"
#include "visibility/query_batch.h"

namespace sightline {

/// Buffers of one thread.
class EyeAbsorption {
 public:
  explicit EyeAbsorption(const World& world) : rays_(world) {}

  /// Without media there is nothing to do.
  bool any() const { return rays_.media().any(); }
  void begin(std::size_t eyes) { eyes_.resize(eyes); }
  void set_eye(std::size_t k, const EyeSample& eye) { eyes_[k] = {eye.geometric_normal, eye.medium, eye.beyond}; }
  /// Beer-Lambert on all contributions whose weight is not 0, between the ends that `queries` has for them.
  void apply(const QueryBatch& queries, std::span<const float> weights, Contributions& contributions, RayCounts& counts);

 private:
  struct Eye {
    Vec3 normal{0};  ///< on the side that the path arrived from
    MediumId medium, beyond;
  };

  MediumRays rays_;
  std::vector<Eye> eyes_;
  RayBatch arriving_;
  std::vector<MediumId> medium_;
  std::vector<std::uint32_t> contribution_;
};

}  // namespace sightline
