// Every tile gets the samples that it lacks, once.
#include "methods/tile_loop.h"

#include <gtest/gtest.h>

#include <map>
#include <mutex>

#include "base/core/error.h"

namespace sightline {
namespace {

using Calls = std::map<std::uint32_t, std::vector<SampleRange>>;

Calls run(Frame& frame, SampleRange range, PassStatistics& statistics, Context& context) {
  Calls calls;
  std::mutex mutex;
  for_each_tile(context, frame, range, statistics, [&](const Tile& tile, SampleRange samples, PassStatistics& local) {
    local.rays.closest = samples.count();
    const std::lock_guard lock(mutex);
    calls[tile.index].push_back(samples);
  });
  return calls;
}

TEST(TileLoop, GivesEveryTileTheWholeRangeOnce) {
  Frame frame(200, 100, {}, 5);
  PassStatistics statistics;
  Context context;
  context.threads = 3;
  const Calls calls = run(frame, {5, 12}, statistics, context);
  EXPECT_EQ(calls.size(), frame.tile_count());
  for (const auto& [tile, ranges] : calls) EXPECT_EQ(ranges, std::vector({SampleRange{5, 12}})) << tile;
  EXPECT_EQ(frame.samples_done(), 7u);
  EXPECT_EQ(statistics.rays.closest, 7 * frame.tile_count());
}

TEST(TileLoop, TilesGetOnlyWhatTheyLack) {
  Frame frame(100, 32, {});
  frame.set_samples_done(0, 4);
  frame.set_samples_done(1, 10);
  frame.set_samples_done(2, 12);
  PassStatistics statistics;
  Context context;
  const Calls calls = run(frame, {0, 10}, statistics, context);
  EXPECT_EQ(calls, (Calls{{0, {{4, 10}}}, {3, {{0, 10}}}}));
  EXPECT_EQ(frame.samples_done(2), 12u);
  EXPECT_EQ(frame.samples_done(), 10u);
}

TEST(TileLoop, CancellingKeepsWholeTiles) {
  Frame frame(320, 320, {});
  Context context;
  context.threads = 2;
  PassStatistics statistics;
  std::atomic<int> calls{0};
  EXPECT_THROW(for_each_tile(context, frame, {0, 3}, statistics,
                             [&](const Tile&, SampleRange, PassStatistics&) {
                               if (++calls == 10) context.cancelled = true;
                             }),
               Error);
  int done = 0;
  for (const std::uint32_t samples : frame.samples_per_tile()) {
    EXPECT_TRUE(samples == 0 || samples == 3);
    done += samples == 3;
  }
  EXPECT_EQ(done, calls);
  EXPECT_LT(done, 20);
}

}  // namespace
}  // namespace sightline
