// Pixels on the edges of what the camera sees.
#pragma once

#include <cstdint>
#include <vector>

#include "methods/fragments/g_buffer.h"
#include "methods/fragments/pyramid.h"

namespace sightline {

/// Appends the pixels of `tile` (elements of `g`, row by row) that one of their four neighbours differs from: by kind, by more than tau_n
/// in the normal or by more than tau_d in depth. Both sides of an edge find it; reads one pixel around the tile.
void edge_pixels(const GBuffer& g, const RootTile& tile, const GeometryOptions& options, std::vector<std::uint32_t>& pixels);

/// A pixel among the 3 x 3 around `pixel` that shows the surface which `point`, an element of `points`, lies on, the nearest of them; or
/// kNoPixel.
inline constexpr std::uint32_t kNoPixel = ~std::uint32_t{0};
std::uint32_t same_surface_near(const GBuffer& g, std::uint32_t pixel, const GBuffer& points, std::size_t point);

}  // namespace sightline
