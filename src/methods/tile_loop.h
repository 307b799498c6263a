// Runs a kernel over the tiles of a frame in parallel.
#pragma once

#include <functional>

#include "film/frame.h"
#include "methods/method.h"

namespace sightline {

/// Calls kernel(tile, samples, statistics) for every tile that lacks samples of `range`, in parallel, and marks them done afterwards.
/// `samples` is what the tile still lacks (after a resume less than `range`).
void for_each_tile(const Context& context, Frame& frame, SampleRange range, PassStatistics& statistics,
                   const std::function<void(const Tile&, SampleRange, PassStatistics&)>& kernel);

}  // namespace sightline
