// What a worker of the cache promises: truth where nothing is shared, rays counted, scopes that know nothing of each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cache_cases.h"

namespace sightline::test {
namespace {

std::shared_ptr<const World> worker_world() {
  std::mt19937 random(1);
  Scene scene = scene_of(triangle_soup(random, 60, 0.7f, 0.3f));
  place(scene, box_mesh(Vec3(-1), Vec3(1)));
  return World::build(std::move(scene), {}, Context());
}

/// A floor of 40x40 pixels under points of light, or points of area lights, in some mesh.
QueryBatch floor_batch(std::uint32_t lights, QuerySemantic semantic, float height = 0.9f) {
  constexpr std::uint32_t kEdge = 40;
  std::mt19937 random(5);
  QueryBatch batch;
  batch.eye.resize(kEdge * kEdge);
  batch.resize_lights(lights);
  batch.resize_queries(std::size_t{kEdge} * kEdge * lights);
  for (std::uint32_t i = 0; i < kEdge * kEdge; ++i) {
    const Vec3 p{0.02f * static_cast<float>(i % kEdge) - 0.4f, -1, 0.02f * static_cast<float>(i / kEdge) - 0.4f};
    batch.eye.set(i, p, {0, 1, 0}, 1e-6f, 4e-4f, 1000 + i);
  }
  for (std::uint32_t l = 0; l < lights; ++l) {
    Vec3 position = 0.5f * random_point(random, 1);
    position.y = height;
    const bool infinite = is_infinite(semantic), surface = semantic == QuerySemantic::surface;
    batch.light.set(l, infinite ? glm::normalize(position) : position, surface ? Vec3(0, -1, 0) : Vec3(0), 0,
                    1.f / static_cast<float>(lights), 7000 + l);
    batch.semantic[l] = static_cast<std::uint8_t>(semantic);
  }
  for (std::uint32_t i = 0; i < batch.size; ++i) batch.eye_of[i] = i / lights, batch.light_of[i] = i % lights;
  return batch;
}

std::size_t differences(const std::vector<float>& a, const std::vector<float>& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += a[i] != b[i];
  return count;
}

std::uint64_t answered(const VisibilityCounts& counts) {
  std::uint64_t sum = 0;
  for (const std::uint64_t n : counts.answered_at_depth) sum += n;
  return sum;
}

const std::vector<QuerySemantic> kSemantics = {QuerySemantic::point, QuerySemantic::direction, QuerySemantic::surface,
                                               QuerySemantic::solid_angle};

TEST(CachedWorker, VanishingCellsGiveExactVisibility) {
  const auto world = worker_world();
  for (const QuerySplit split : {QuerySplit::eye, QuerySplit::symmetric}) {
    for (const QuerySemantic semantic : kSemantics) {
      QueryBatch batch = floor_batch(20, semantic);
      batch.split = split;
      // Cells of the light's own density do not shrink with C_E: give each its own.
      for (std::size_t l = 0; l < batch.light.size; ++l) batch.light.cell_area[l] = 1e-9f;
      const Answers exact = Cache(world, {}, "exact").ask(batch);
      const Answers cached = Cache(world, {"ce=0.01", "table_bits=22"}).ask(batch);
      EXPECT_EQ(differences(exact.weights, cached.weights), 0u) << int(semantic);
      EXPECT_EQ(cached.counts.queries, batch.size);
      const double lit = std::count(exact.weights.begin(), exact.weights.end(), 1.f) / static_cast<double>(batch.size);
      EXPECT_TRUE(is_infinite(semantic) || (lit > 0.05 && lit < 0.95)) << lit;
    }
  }
}

TEST(CachedWorker, OneCellIsOneRayForEachOrientationAndLight) {
  const auto world = worker_world();
  for (const QuerySemantic semantic : {QuerySemantic::point, QuerySemantic::direction}) {
    QueryBatch batch = floor_batch(5, semantic);
    for (const char* refine : {"refine=none", "refine=4"}) EXPECT_EQ(Cache(world, {"ce=1000000", refine}).ask(batch).counts.traced, 5u);
    for (std::size_t i = 0; i < batch.eye.size; i += 2) batch.eye.set(i, end_position(batch.eye, i), {0, -1, 0}, 0, 4e-4f, 0);
    EXPECT_EQ(Cache(world, {"ce=1000000"}).ask(batch).counts.traced, 10u);
  }
}

TEST(CachedWorker, LitAndDarkScenesAreExact) {
  // A lid between floor and lights, or none.
  for (const bool dark : {false, true}) {
    Scene scene = scene_of(make_mesh({{-2, -1, -2}, {2, -1, -2}, {2, -1, 2}, {-2, -1, 2}}, {{0, 2, 1}, {0, 3, 2}}));
    if (dark) place(scene, box_mesh({-1.5f, -1.5f, -1.5f}, {1.5f, 0, 1.5f}));
    const auto world = World::build(std::move(scene), {}, Context());
    for (const QuerySemantic semantic : kSemantics) {
      const QueryBatch batch = floor_batch(16, semantic);
      const Answers answers = Cache(world, {"residual=0.1"}).ask(batch);
      for (const float w : answers.weights) ASSERT_EQ(w, dark ? 0 : 1);
      EXPECT_LT(answers.counts.traced, batch.size / 4);
    }
  }
}

TEST(CachedWorker, CountsAddUp) {
  const auto world = worker_world();
  for (const std::vector<std::string>& settings : std::vector<std::vector<std::string>>{{},
                                                                                        {"refine=none"},
                                                                                        {"refine=64"},
                                                                                        {"hash=recurrence"},
                                                                                        {"hash=mix64"},
                                                                                        {"counters=2"},
                                                                                        {"residual=0.1"},
                                                                                        {"light_refine=2"},
                                                                                        {"group=16"},
                                                                                        {"group=100000"},
                                                                                        {"table_bits=10"}}) {
    for (const QuerySemantic semantic : kSemantics) {
      QueryBatch batch = floor_batch(16, semantic);
      for (std::size_t i = 0; i < batch.size; i += 7) batch.light_of[i] = kNoQuery;
      const Answers a = Cache(world, settings).ask(batch);
      const std::size_t gaps = (batch.size + 6) / 7;
      EXPECT_EQ(a.counts.queries, batch.size - gaps);
      EXPECT_EQ(a.counts.cached + a.counts.traced - a.counts.residual, a.counts.queries);
      EXPECT_EQ(answered(a.counts), a.counts.cached);
      EXPECT_EQ(a.rays.occlusion, a.counts.traced);
      EXPECT_GE(a.counts.lookups, a.counts.cached);
      for (std::size_t i = 0; i < batch.size; i += 7) ASSERT_EQ(a.weights[i], 0);
    }
  }
}

TEST(CachedWorker, MostAnswersAreRightAndCostFewRays) {
  const auto world = worker_world();
  for (const QuerySemantic semantic : kSemantics) {
    const QueryBatch batch = floor_batch(64, semantic);
    const Answers exact = Cache(world, {}, "exact").ask(batch);
    for (const char* hash : {"hash=separable", "hash=recurrence", "hash=mix64"}) {
      const Answers cached = Cache(world, {"ce=4", hash}).ask(batch);
      EXPECT_LT(static_cast<double>(differences(exact.weights, cached.weights)), 0.12 * static_cast<double>(batch.size)) << int(semantic);
      EXPECT_LT(cached.counts.traced, batch.size / 2);
    }
  }
}

TEST(CachedWorker, EndsOfUnknownAreaAreTraced) {
  const auto world = worker_world();
  QueryBatch batch = floor_batch(16, QuerySemantic::surface);
  const Answers exact = Cache(world, {}, "exact").ask(batch);
  for (std::size_t i = 0; i < batch.eye.size; i += 3) batch.eye.cell_area[i] = 0;
  batch.light.cell_area[5] = 0;
  const Answers cached = Cache(world, {"ce=16"}).ask(batch);
  std::size_t unknown = 0;
  for (std::size_t i = 0; i < batch.size; ++i) {
    if (batch.eye_of[i] % 3 != 0 && batch.light_of[i] != 5) continue;
    ASSERT_EQ(cached.weights[i], exact.weights[i]);
    ++unknown;
  }
  EXPECT_GE(cached.counts.traced, unknown);
}

TEST(CachedWorker, ImportantQueriesAreTraced) {
  const auto world = worker_world();
  for (const QuerySplit split : {QuerySplit::eye, QuerySplit::symmetric}) {
    QueryBatch batch = floor_batch(32, QuerySemantic::surface);
    batch.split = split;
    const Cache cache(world, {"ce=32", "importance=4"});
    const Answers exact = Cache(world, {}, "exact").ask(batch), alike = cache.ask(batch);
    batch.importance.resize(padded(batch.size), 1);
    EXPECT_EQ(cache.ask(batch).weights, alike.weights);
    std::size_t important = 0, wrong = 0;
    for (std::size_t i = 0; i < batch.size; i += 5) {
      batch.importance[i] = 4.5f, ++important;
      wrong += alike.weights[i] != exact.weights[i];
    }
    EXPECT_GT(wrong, 0u);  // there is something to gain
    const Answers answers = cache.ask(batch);
    for (std::size_t i = 0; i < batch.size; i += 5) ASSERT_EQ(answers.weights[i], exact.weights[i]);
    EXPECT_GE(answers.counts.traced, important);
    EXPECT_LT(answers.counts.traced, important + alike.counts.traced + 1);
    EXPECT_EQ(answers.counts.queries, batch.size);
    EXPECT_EQ(Cache(world, {"ce=32", "importance=0"}).ask(batch).counts.traced, alike.counts.traced);
  }
}

TEST(CachedWorker, CountersFindMixedCellsByRays) {
  const auto world = worker_world();
  const QueryBatch batch = floor_batch(64, QuerySemantic::surface);
  const Answers exact = Cache(world, {}, "exact").ask(batch);
  const Answers plain = Cache(world, {"ce=8", "counters=0"}).ask(batch);
  EXPECT_EQ(Cache(world, {"ce=8", "counters=1"}).ask(batch).counts.queries, plain.counts.queries);
  Answers last = plain;
  for (const char* counters : {"counters=2", "counters=5"}) {
    Answers counted = Cache(world, {"ce=8", counters}).ask(batch);
    EXPECT_GT(counted.counts.traced, last.counts.traced);
    EXPECT_LT(differences(exact.weights, counted.weights), differences(exact.weights, last.weights));
    last = std::move(counted);
  }
}

TEST(CachedWorker, ScopesKnowNothingOfEachOther) {
  const auto world = worker_world();
  const QueryBatch batch = floor_batch(32, QuerySemantic::surface), other = floor_batch(7, QuerySemantic::point);
  const Cache cache(world, {"table_bits=16"});
  const auto fresh = cache.visibility->worker(), used = cache.visibility->worker();
  for (std::uint32_t scope = 0; scope < 5; ++scope) used->begin(scope), (void)cache.ask(*used, scope % 2 ? batch : other);
  fresh->begin(9), used->begin(9);
  const Answers a = cache.ask(*fresh, batch), b = cache.ask(*used, batch);
  EXPECT_EQ(a.weights, b.weights);
  EXPECT_EQ(a.counts.traced, b.counts.traced);
  EXPECT_EQ(a.counts.rejected, b.counts.rejected);
}

TEST(CachedWorker, AnswersLastUntilTheNextScope) {
  const auto world = worker_world();
  const QueryBatch batch = floor_batch(32, QuerySemantic::surface);
  // Without refinement: neighbours that became known would call for finer cells the second time.
  const Cache cache(world, {"refine=none"});
  const auto worker = cache.visibility->worker();
  const std::uint64_t first = cache.ask(*worker, batch).counts.traced;
  EXPECT_LT(cache.ask(*worker, batch).counts.traced, first / 20);  // slots that two keys fight for
  worker->begin(0);
  EXPECT_EQ(cache.ask(*worker, batch).counts.traced, first);
}

TEST(CachedWorker, OwnCeOfAKindOfLightCountsForItAlone) {
  const auto world = worker_world();
  QueryBatch batch = floor_batch(16, QuerySemantic::point);
  for (std::size_t l = 0; l < 16; l += 2) {
    batch.semantic[l] = static_cast<std::uint8_t>(QuerySemantic::surface);
    batch.light.set(l, end_position(batch.light, l), {0, -1, 0}, 0, 1e-9f, 0);
  }
  const Answers exact = Cache(world, {}, "exact").ask(batch);
  for (const SurfaceEnds kind : {SurfaceEnds::area_light, SurfaceEnds::virtual_light, SurfaceEnds::path_vertex}) {
    batch.surface_ends = kind;
    for (const char* own : {"ce_area=0.01", "ce_vpl=0.01", "ce_point=0.01"}) {
      const Answers cached = Cache(world, {"ce=16", "refine=none", own, "table_bits=20"}).ask(batch);
      std::size_t wrong_points = 0, wrong_surfaces = 0;
      for (std::size_t i = 0; i < batch.size; ++i) {
        const bool point = batch.semantic[batch.light_of[i]] == static_cast<std::uint8_t>(QuerySemantic::point);
        (point ? wrong_points : wrong_surfaces) += cached.weights[i] != exact.weights[i];
      }
      const std::string name = own;
      const bool exact_surfaces =
          (name == "ce_area=0.01" && kind == SurfaceEnds::area_light) || (name == "ce_vpl=0.01" && kind == SurfaceEnds::virtual_light);
      EXPECT_EQ(wrong_surfaces == 0, exact_surfaces) << name;
      EXPECT_EQ(wrong_points == 0, name == "ce_point=0.01") << name;
      EXPECT_EQ(cached.counts.queries, batch.size);
    }
  }
}

TEST(CachedWorker, ResidualOfProbabilityOneIsExact) {
  const auto world = worker_world();
  const QueryBatch batch = floor_batch(16, QuerySemantic::surface);
  EXPECT_EQ(Cache(world, {"ce=32", "residual=1"}).ask(batch).weights, Cache(world, {}, "exact").ask(batch).weights);
}

TEST(CachedWorker, ResidualIsRightInTheMean) {
  const auto world = worker_world();
  QueryBatch batch = floor_batch(16, QuerySemantic::surface);
  const Answers exact = Cache(world, {}, "exact").ask(batch);
  const Cache biased(world, {"ce=32", "refine=none"}), corrected(world, {"ce=32", "refine=none", "residual=0.2"});
  EXPECT_TRUE(biased.visibility->binary());
  EXPECT_FALSE(corrected.visibility->binary());
  double truth = 0, mean = 0, square = 0;
  for (const float w : exact.weights) truth += w;
  constexpr int kRuns = 40;
  for (int run = 0; run < kRuns; ++run) {
    for (std::size_t i = 0; i < batch.eye.size; ++i)
      batch.eye.id[i] = static_cast<std::uint32_t>(i * 977 + static_cast<std::size_t>(run) * 7919);
    double sum = 0;
    for (const float w : corrected.ask(batch).weights) sum += w;
    mean += sum / kRuns, square += sum * sum / kRuns;
  }
  const double sigma = std::sqrt((square - mean * mean) / (kRuns - 1));
  EXPECT_NEAR(mean, truth, 4 * sigma);
  double without = 0;
  for (const float w : biased.ask(batch).weights) without += w;
  EXPECT_GT(std::fabs(without - truth), 8 * sigma);  // there is something to correct
}

TEST(CachedWorker, LightRefinementComesAfterTheEyes) {
  const auto world = worker_world();
  const QueryBatch batch = floor_batch(64, QuerySemantic::surface);
  const Answers exact = Cache(world, {}, "exact").ask(batch);
  const Answers plain = Cache(world, {"ce=4"}).ask(batch), finer = Cache(world, {"ce=4", "light_refine=2"}).ask(batch);
  EXPECT_LT(differences(exact.weights, finer.weights), differences(exact.weights, plain.weights));
  EXPECT_EQ(plain.counts.answered_at_depth[3], 0u);
  EXPECT_GT(finer.counts.answered_at_depth[4], 0u);
}

TEST(CachedWorker, EmptySceneIsLit) {
  const auto world = World::build(Scene(), {}, Context());
  const QueryBatch batch = floor_batch(4, QuerySemantic::surface);
  for (const float w : Cache(world, {}).ask(batch).weights) ASSERT_EQ(w, 1);
  QueryBatch nothing;
  nothing.resize_queries(0);
  EXPECT_TRUE(Cache(world, {}).ask(nothing).weights.empty());
}

TEST(CachedWorker, EveryTargetGivesTheSameBits) {
  const auto world = worker_world();
  const QueryBatch batch = floor_batch(32, QuerySemantic::surface);
  const Answers best = Cache(world, {}).ask(batch);
  for (const std::int64_t target : simd_targets()) {
    const PinnedTarget pinned(target);
    EXPECT_EQ(Cache(world, {}).ask(batch).weights, best.weights) << hwy::TargetName(target);
  }
}

}  // namespace
}  // namespace sightline::test
