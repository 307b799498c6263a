// An edge-avoiding filter for what is left of noise in penumbrae.
#pragma once

#include <cstdint>
#include <span>

#include "methods/fragments/g_buffer.h"

namespace sightline {

/// Writes the pixels of `tile` to `out` (laid out as the GBuffer, as are `signal` and `level`); reads up to kSmoothReach pixels around it.
///
/// `signal` is the visible share of a light, `level` that of the fragment a pixel's value comes from, which says how noisy it is. A plane
/// is fitted to the values of a window of 5 x 5 pixels on the same surface, or a parabola where that is significant. Where the noise of
/// stratified shadow rays explains how far values lie from the fit, a pixel takes the fit's value; where it does not, there is something
/// to be seen, and the pixel keeps its own. So wide penumbrae lose their noise and nothing else, and narrow ones stay as they are. In
/// coarser fragments, whose pixels have their noise in common, the window's pixels lie further apart.
///
/// The bits of a pixel do not depend on the tile it is computed with.
void smooth(const GBuffer& g, std::span<const float> signal, std::span<const std::uint8_t> level, const RootTile& tile,
            std::span<float> out);

inline constexpr int kSmoothReach = 8;

}  // namespace sightline
