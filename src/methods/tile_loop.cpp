#include "methods/tile_loop.h"

#include <algorithm>
#include <mutex>

#include "base/parallel/parallel.h"

namespace sightline {

void for_each_tile(const Context& context, Frame& frame, SampleRange range, PassStatistics& statistics,
                   const std::function<void(const Tile&, SampleRange, PassStatistics&)>& kernel) {
  std::mutex mutex;
  std::size_t tiles_done = 0;
  parallel_for(context, frame.tile_count(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t index = begin; index < end; ++index) {
      const std::uint32_t have_until = frame.first_sample() + frame.samples_done(index);
      const SampleRange missing{std::max(range.begin, have_until), range.end};
      if (missing.begin >= missing.end) continue;
      PassStatistics local;
      kernel(frame.tile(index), missing, local);
      frame.set_samples_done(index, missing.end - frame.first_sample());
      const std::lock_guard lock(mutex);
      statistics += local;
      context.report("render", static_cast<double>(++tiles_done), static_cast<double>(frame.tile_count()));
    }
  });
}

}  // namespace sightline
