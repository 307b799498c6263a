// Which lights an occluder may hide from a receiver, on the machine's best vectors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/core/aligned.h"
#include "base/math/vec.h"
#include "methods/square_lights/occluder_place.h"
#include "methods/square_lights/shade_lanes.h"

namespace sightline::square_lights {

/// Of the cones around lights' centres within which an occluder may touch their squares; padded as the lights are.
struct ReachLanes {
  AlignedVector<float> cosine, sine;
};

/// Lights that are worth looking at for one receiver.
struct ActiveLights {
  AlignedVector<float> on;  ///< by light: 1 or 0; padded
  AlignedVector<std::uint32_t> index;
  std::size_t count = 0;
  std::span<const std::uint32_t> indices() const { return std::span(index).first(count); }
};
/// Those whose square reaches above the horizon of `normal` and whose value lies above `least_by_radius` times r_p, which is r times
/// `plane_scale`: distances, of which half an edge below 0 is fully hidden, or, with 0, visible parts.
void find_active(const LightSet& lights, const Vec3& normal, float plane_scale, std::span<const float> value, float least_by_radius,
                 ActiveLights& active);

/// Lights turned into an occluder's space; lanes up to the next multiple of kLanes repeat the last light, so that they read what is read
/// anyway.
struct NearLights {
  AlignedVector<float> x, y, z, r;
  AlignedVector<std::uint32_t> index;
  std::size_t count = 0;
  LightLanes lanes() const {
    const std::size_t n = padded(count);
    return {std::span(x).first(n), std::span(y).first(n), std::span(z).first(n), std::span(r).first(n), count};
  }
};
/// Active lights that `may` (1 or 0 by light, padded) takes and whose cone comes near the occluder's, turned by `turn`.
void find_near(const LightSet& lights, const ActiveLights& active, std::span<const float> may, const ReachLanes& reach,
               const OccluderCone& cone, const Mat3& turn, NearLights& near);

}  // namespace sightline::square_lights
