// What virtual point lights that are no Lamberts send to many eye points, 16 at a time.
//
// The scalar definition is radiance_towards() of virtual_point_lights.h; tests compare the two.
#pragma once

#include <cstdint>
#include <span>

#include "methods/visibility_cache/virtual_point_lights.h"

namespace sightline {

/// Radiance by light and point: that of the i-th light for point k is element i * stride + k.
struct SentRadiance {
  Vec3Batch radiance;
  std::size_t stride = 0;
};

/// Fills `sent` with what the lights listed in `which` send to `points` [0, count).
void send_radiance(const VirtualPointLights& lights, std::span<const std::uint32_t> which, const Vec3Batch& points, std::size_t count,
                   SentRadiance& sent);

}  // namespace sightline
