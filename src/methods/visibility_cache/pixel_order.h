// The order in which a tile's pixels ask: spread out first, then ever denser, each stage along a space-filling curve [Popov2013].
#pragma once

#include <cstdint>
#include <vector>

namespace sightline {

/// All pixels of a width x height tile (index y * width + x), each once. Halton points (bases 2, 3) are enumerated exactly and cut into
/// segments that end after first_segment (C_PI, at least 1), first_segment growth, first_segment growth² ... pixels (C_PG = growth > 1);
/// each segment is sorted along the Morton curve, so that neighbours in the order are neighbours in the picture.
std::vector<std::uint32_t> halton_order(int width, int height, double first_segment, double growth);

/// Row by row: the ablation.
std::vector<std::uint32_t> scanline_order(int width, int height);

}  // namespace sightline
