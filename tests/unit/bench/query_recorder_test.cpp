#include "bench/visibility_cache/query_recorder.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "visibility/visibility.h"

namespace sightline {
namespace {

CacheView small_cornell() {
  CacheBenchOptions options;
  options.size_px = IVec2(48, 40);
  CacheView view = *load_cache_view("builtin:cornell", options, Context());
  view.light_samples = 4;
  return view;
}

VisibilityCounts answered(const std::vector<RecordedScope>& scopes, const CacheView& view, const std::string& visibility) {
  const std::unique_ptr<Visibility> made = find_visibility(visibility).make(view.world, find_visibility(visibility).settings, Context());
  made->begin_pass({0, 0}, Context());
  const std::unique_ptr<VisibilityWorker> worker = made->worker();
  VisibilityCounts counts;
  for (const RecordedScope& scope : scopes) {
    worker->begin(scope.scope);
    for (const QueryBatch& batch : scope.batches) {
      AlignedVector<float> weights(padded(batch.size) + kLanes);
      RayCounts rays;
      worker->visible(batch, weights, rays, counts);
    }
  }
  return counts;
}

// Replayed alone, the batches trace as many rays as in the picture: order and scopes are the method's.
TEST(QueryRecorder, ReplayedBatchesAreThoseOfThePicture) {
  const CacheView view = small_cornell();
  for (const std::string visibility : {"cached", "exact"}) {
    const Shot shot = shoot(view, {.visibility = visibility}, Context());
    const std::vector<RecordedScope> scopes = record_queries(view, visibility, {}, 1u << 30, Context());
    const VisibilityCounts counts = answered(scopes, view, visibility);
    EXPECT_GT(counts.queries, 0u);
    EXPECT_EQ(counts.queries, shot.statistics.visibility.queries) << visibility;
    EXPECT_EQ(counts.traced, shot.statistics.visibility.traced) << visibility;
  }
}

TEST(QueryRecorder, ScopesComeInOrderWhateverTheThreads) {
  const CacheView view = small_cornell();
  Context context;
  context.threads = 3;
  const std::vector<RecordedScope> scopes = record_queries(view, "cached", {}, 1u << 30, context);
  ASSERT_GT(scopes.size(), 1u);
  for (std::size_t i = 1; i < scopes.size(); ++i) EXPECT_LT(scopes[i - 1].scope, scopes[i].scope);
}

TEST(CacheView, BackgroundAndLightsAreMaskedOut) {
  const CacheView view = small_cornell();
  const std::vector<std::uint8_t> mask = surface_mask(view, 1, {}, Context());
  const auto kept = static_cast<std::size_t>(std::count(mask.begin(), mask.end(), 1));
  EXPECT_GT(kept, mask.size() / 2);
  EXPECT_LT(kept, mask.size());
}

}  // namespace
}  // namespace sightline
