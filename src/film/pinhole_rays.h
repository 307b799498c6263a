// Primary rays of cameras without lens, in SIMD. The scalar definition is View::ray_through.
#pragma once

#include <cstddef>
#include <cstdint>

#include "film/view.h"

namespace sightline {

/// An affine picture plane: perspective rays start at `position` towards origin + x step_x + y step_y; orthographic ones start there and
/// go along `position`.
struct PinholeRays {
  Vec3 origin, step_x, step_y, position;
  bool orthographic;
  std::uint32_t width;
  const float* filter_table;  ///< PixelFilter::table()
};

/// Lanes [0, padded(count)) are written. The arrays are 64-byte aligned.
void pinhole_rays(const PinholeRays& job, const std::uint32_t* pixels, const float* fx, const float* fy, std::size_t count,
                  const CameraRays& rays);

}  // namespace sightline
