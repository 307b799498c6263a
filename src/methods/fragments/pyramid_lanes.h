// Changes of normal and depth between neighbouring pixels, a row at a time.
#pragma once

#include <cstddef>
#include <cstdint>

#include "methods/fragments/g_buffer.h"

namespace sightline {

/// A run of pixels of one row that starts at element `first` of the G-buffer, and what to compare it with.
struct DiscontinuityRow {
  std::size_t first, count;     ///< count: pixels that lie in the picture
  bool right_edge, lower_edge;  ///< the last pixel has no right neighbour; the row has no lower one
  bool plane_distance;          ///< depth as distance from the tangent plane
};

/// kappa = sqrt(|N - N_right|^2 + |N - N_lower|^2), dz = the larger relative change of depth; both infinite where one of two pixels is
/// interpolated and the other is not, or their kinds differ. any = 1 for pixels that are interpolated; flat (may be null) as in GBuffer.
/// Writes padded(count).
void discontinuities(const GBuffer& g, const DiscontinuityRow& row, float* kappa, float* dz, std::uint8_t* any, std::uint8_t* flat);

/// What makes a pixel flat: change of the normal, slope of the way to a neighbour against the tangent plane, and its length over depth. So
/// little that sixteen steps from one flat pixel to the next do not leave a surface in the sense of smoothing.
inline constexpr float kFlatBend = 0.02f, kFlatSlope = 2e-3f, kFlatReach = 0.02f;

}  // namespace sightline
