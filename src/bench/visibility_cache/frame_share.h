// How much of a frame goes into visibility.
#pragma once

#include <string>
#include <vector>

#include "bench/visibility_cache/cache_view.h"

namespace sightline {

struct FrameShare {
  double frame_seconds = 0;
  double core_seconds = 0;  ///< in the visibility, summed over threads
  VisibilityCounts counts;
};

/// One sample a pixel, with a clock around every batch of queries; the faster of two runs.
FrameShare measure_frame_share(const CacheView& view, const std::string& visibility, const std::vector<std::string>& settings,
                               const Context& context);

}  // namespace sightline
