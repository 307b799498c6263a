// Primary rays of cameras without lens, in SIMD. The scalar definition is View::ray_through.
#pragma once

#include <cstddef>
#include <cstdint>

#include "film/view.h"

namespace sightline {

/// Lanes [0, padded(count)) are written. The arrays are 64-byte aligned.
void pinhole_rays(const PinholeRays& job, const std::uint32_t* pixels, const float* fx, const float* fy, std::size_t count,
                  const CameraRays& rays);

}  // namespace sightline
