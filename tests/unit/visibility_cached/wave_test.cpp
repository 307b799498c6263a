// Waves of a pass: the same bits for any number of threads, answers shared between batches and waves.
#include <gtest/gtest.h>

#include <cmath>

#include "base/parallel/parallel.h"
#include "cache_cases.h"

namespace sightline::test {
namespace {

std::shared_ptr<const World> soup_world() {
  std::mt19937 random(1);
  Scene scene = scene_of(triangle_soup(random, 60, 0.7f, 0.3f));
  place(scene, box_mesh(Vec3(-1), Vec3(1)));
  return World::build(std::move(scene), {}, Context());
}

/// Connections between points of two walls, as batches of a wave.
std::vector<QueryBatch> connections(int seed, std::size_t batches, QuerySplit split) {
  std::mt19937 random(static_cast<std::uint32_t>(seed));
  std::uniform_real_distribution<float> u(-1, 1);
  std::vector<QueryBatch> result(batches);
  for (QueryBatch& batch : result) {
    const std::size_t n = 500 + random() % 800;
    batch.eye.resize(n), batch.resize_lights(n), batch.resize_queries(n);
    batch.split = split;
    batch.surface_ends = SurfaceEnds::path_vertex;
    for (std::uint32_t i = 0; i < n; ++i) {
      batch.eye.set(i, {u(random), -1, u(random)}, {0, 1, 0}, 1e-6f, 1e-3f, static_cast<std::uint32_t>(random()));
      batch.light.set(i, {u(random), 1, u(random)}, {0, -1, 0}, 1e-6f, i % 50 == 0 ? 0.f : 1e-3f, static_cast<std::uint32_t>(random()));
      batch.semantic[i] = static_cast<std::uint8_t>(QuerySemantic::surface);
      batch.eye_of[i] = i, batch.light_of[i] = i % 33 == 7 ? kNoQuery : i;
    }
  }
  return result;
}

struct Pass {
  std::vector<std::vector<float>> weights;
  VisibilityCounts counts;
  RayCounts rays;
};

/// One wave, looked up and resolved in parallel.
void run_wave(const Cache& cache, const std::vector<QueryBatch>& batches, const Context& context, Pass& pass) {
  const std::unique_ptr<VisibilityWave> wave = cache.visibility->wave(batches.size());
  std::vector<VisibilityCounts> counts(batches.size());
  std::vector<RayCounts> rays(batches.size());
  parallel_for(context, batches.size(), 1,
               [&](std::size_t begin, std::size_t) { wave->look_up(begin, batches[begin], rays[begin], counts[begin]); });
  wave->trace(context, pass.rays, pass.counts);
  std::vector<AlignedVector<float>> weights(batches.size());
  parallel_for(context, batches.size(), 1, [&](std::size_t begin, std::size_t) {
    weights[begin].assign(padded(batches[begin].size), -7.f);
    wave->resolve(begin, weights[begin]);
  });
  for (std::size_t i = 0; i < batches.size(); ++i) {
    pass.weights.emplace_back(weights[i].begin(), weights[i].begin() + static_cast<std::ptrdiff_t>(batches[i].size));
    pass.counts += counts[i], pass.rays += rays[i];
  }
}

Pass run(const Cache& cache, int threads, QuerySplit split, int waves = 3) {
  Context context;
  context.threads = threads;
  cache.visibility->begin_pass({}, context);
  Pass pass;
  for (int w = 0; w < waves; ++w) run_wave(cache, connections(w, 9, split), context, pass);
  return pass;
}

void expect_equal(const Pass& a, const Pass& b) {
  EXPECT_EQ(a.weights, b.weights);
  EXPECT_EQ(a.counts.queries, b.counts.queries);
  EXPECT_EQ(a.counts.traced, b.counts.traced);
  EXPECT_EQ(a.counts.cached, b.counts.cached);
  EXPECT_EQ(a.counts.lookups, b.counts.lookups);
  EXPECT_EQ(a.counts.rejected, b.counts.rejected);
  EXPECT_EQ(a.counts.answered_at_depth, b.counts.answered_at_depth);
}

TEST(CachedWave, AnswersDoNotDependOnThreads) {
  const auto world = soup_world();
  for (const std::vector<std::string>& settings : std::vector<std::vector<std::string>>{
           {"ce=12"}, {"ce=12", "shared_table_bits=11"}, {"ce=12", "scope=tile"}, {"ce=12", "residual=0.2"}, {"ce=12", "counters=2"}}) {
    for (const QuerySplit split : {QuerySplit::symmetric, QuerySplit::eye}) {
      const Pass one = run(Cache(world, settings), 1, split);
      for (const int threads : {2, 7}) expect_equal(run(Cache(world, settings), threads, split), one);
      EXPECT_EQ(one.counts.cached + one.counts.traced - one.counts.residual, one.counts.queries);
      EXPECT_EQ(one.rays.occlusion, one.counts.traced);
      EXPECT_LT(one.counts.traced, one.counts.queries);
    }
  }
}

TEST(CachedWave, FirstQueryOfTheWaveStandsForItsKey) {
  // One cell for all: the answer of everything that can be cached is that of the first query.
  const auto world = soup_world();
  const std::vector<QueryBatch> batches = connections(1, 5, QuerySplit::symmetric);
  std::vector<std::vector<float>> exact;
  for (const QueryBatch& batch : batches) exact.push_back(Cache(world, {}, "exact").ask(batch).weights);
  const Cache cache(world, {"ce=1000000", "residual=0"});
  const Context context;
  cache.visibility->begin_pass({}, context);
  Pass pass;
  run_wave(cache, batches, context, pass);
  std::size_t first = 0;
  while (batches[0].light_of[first] == kNoQuery || batches[0].light.cell_area[first] == 0) ++first;
  for (std::size_t b = 0; b < batches.size(); ++b) {
    for (std::size_t i = 0; i < batches[b].size; ++i) {
      const bool gap = batches[b].light_of[i] == kNoQuery, unknown = !gap && batches[b].light.cell_area[batches[b].light_of[i]] == 0;
      ASSERT_EQ(pass.weights[b][i], gap ? 0 : unknown ? exact[b][i] : exact[0][first]) << b << " " << i;
    }
  }
}

TEST(CachedWave, VanishingCellsGiveExactVisibility) {
  const auto world = soup_world();
  const std::vector<QueryBatch> batches = connections(2, 4, QuerySplit::symmetric);
  const Cache cache(world, {"ce=0.01"});
  const Context context;
  cache.visibility->begin_pass({}, context);
  Pass pass;
  run_wave(cache, batches, context, pass);
  for (std::size_t b = 0; b < batches.size(); ++b) EXPECT_EQ(pass.weights[b], Cache(world, {}, "exact").ask(batches[b]).weights);
}

TEST(CachedWave, WavesOfAPassShareAndPassesDoNot) {
  const auto world = soup_world();
  const std::vector<QueryBatch> batches = connections(3, 4, QuerySplit::symmetric);
  const Context context;
  for (const char* scope : {"scope=tile", "scope=pass", "scope=frame", "reuse=true"}) {
    const Cache cache(world, {"ce=4", scope});
    const auto traced = [&](const VisibilityPass& begin, bool again) {
      if (!again) cache.visibility->begin_pass(begin, context);
      Pass pass;
      run_wave(cache, batches, context, pass);
      return pass.counts.traced;
    };
    const std::uint64_t first = traced({0, 0}, false), same_pass = traced({0, 0}, true), next_pass = traced({16, 0}, false),
                        next_frame = traced({0, 1}, false);
    const std::string name = scope;
    EXPECT_EQ(same_pass < first / 2, name != "scope=tile") << scope;
    EXPECT_EQ(next_pass < first / 2, name == "scope=frame" || name == "reuse=true") << scope;
    EXPECT_EQ(next_frame < first / 2, name == "reuse=true") << scope;
  }
}

TEST(CachedWave, PassesAreIndependent) {
  // A pass after others gives the bits that it gives alone.
  const auto world = soup_world();
  const std::vector<QueryBatch> batches = connections(4, 4, QuerySplit::symmetric);
  const Context context;
  const Cache alone(world, {"ce=12"}), after(world, {"ce=12"});
  Pass a, b, dropped;
  for (const std::uint32_t sample : {0u, 16u, 32u}) {
    after.visibility->begin_pass({sample, 0}, context);
    run_wave(after, batches, context, sample == 32 ? b : dropped);
  }
  alone.visibility->begin_pass({32, 0}, context);
  run_wave(alone, batches, context, a);
  expect_equal(a, b);
}

TEST(CachedWave, TableIsCountedAsMemory) {
  const Cache cache(soup_world(), {"shared_table_bits=12", "table_bits=11"});
  EXPECT_EQ(cache.visibility->memory_bytes(), 0u);
  const auto wave = cache.visibility->wave(1);
  EXPECT_EQ(cache.visibility->memory_bytes(), 4u << 12);
  {
    const auto worker = cache.visibility->worker();
    EXPECT_EQ(cache.visibility->memory_bytes(), (4u << 12) + (4u << 11));
  }
  EXPECT_EQ(cache.visibility->memory_bytes(), 4u << 12);
}

}  // namespace
}  // namespace sightline::test
