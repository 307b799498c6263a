// Parallel work that traces rays.
#pragma once

#include <cstddef>
#include <vector>

#include "base/parallel/parallel.h"
#include "trace/ray_batch.h"

namespace sightline::vpl {

/// Calls work(begin, end, counts) on chunks of `grain` and adds up the rays that they count.
template <class Work>
void for_counted_chunks(std::size_t count, std::size_t grain, const Context& context, RayCounts& rays, const Work& work) {
  std::vector<RayCounts> counts((count + grain - 1) / grain);
  parallel_for(context, count, grain, [&](std::size_t begin, std::size_t end) { work(begin, end, counts[begin / grain]); });
  for (const RayCounts& c : counts) rays += c;
}

}  // namespace sightline::vpl
