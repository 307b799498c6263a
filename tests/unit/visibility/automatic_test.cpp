// The choice between cache and rays: its logic, and that answers go on whichever side is chosen.
#include <gtest/gtest.h>

#include "unit/trace/trace_scenes.h"
#include "visibility/automatic/trial.h"
#include "visibility/visibility.h"

namespace sightline::test {
namespace {

TEST(Trial, SidesTakeTurns) {
  Trial trial;
  int cached = 0, exact = 0;
  for (int i = 0; i < 10; ++i) {
    const Trial::Side side = trial.next();
    ++(side == Trial::cached ? cached : exact);
    trial.add(side, 1, 10);
  }
  EXPECT_EQ(cached, 5);
  EXPECT_EQ(exact, 5);
}

TEST(Trial, ThereIsNoVerdictBeforeBothSidesHaveShownEnough) {
  Trial trial;
  for (int i = 0; i < 20; ++i) trial.add(Trial::cached, 1, 1000000);
  EXPECT_FALSE(trial.verdict());
  for (int i = 0; i + 1 < Trial::kScopes; ++i) trial.add(Trial::exact, 1, Trial::kQueries);
  EXPECT_FALSE(trial.verdict());
  trial.add(Trial::exact, 0, 0);  // an empty tile says nothing
  EXPECT_FALSE(trial.verdict());
  trial.add(Trial::exact, 1, 1);
  EXPECT_TRUE(trial.verdict());
}

TEST(Trial, TheCheaperQueryWins) {
  for (const bool cache_is_cheaper : {false, true}) {
    Trial trial;
    for (int i = 0; i < Trial::kScopes; ++i) {
      trial.add(Trial::cached, cache_is_cheaper ? 1.0 : 5.0, 2 * Trial::kQueries);
      trial.add(Trial::exact, 1.0, Trial::kQueries);
    }
    EXPECT_EQ(trial.verdict(), cache_is_cheaper ? Trial::cached : Trial::exact);
  }
}

// Far-apart points with a cell area so small that no two queries share an answer: both sides must then say the same.
TEST(AutomaticVisibility, AnswersAsRaysDoWhileItTriesAndAfterwards) {
  std::mt19937 random(1);
  const Mesh mesh = triangle_soup(random, 150, 1, 0.3f);
  const auto world = World::build(scene_of(mesh), {}, Context());
  Context context;
  std::string said;
  context.log = [&](LogLevel, std::string_view text) { said += text; };
  const auto make = [&](const char* name) {
    const VisibilityInfo& info = find_visibility(name);
    return info.make(world, info.settings, context);
  };
  const auto automatic = make("auto"), exact = make("exact");
  automatic->begin_pass({}, context);
  const auto trying = automatic->worker(), tracing = exact->worker();
  constexpr std::size_t kCount = 8192;
  std::vector<float> a(kCount), b(kCount);
  for (std::uint32_t scope = 0; scope < 12; ++scope) {
    QueryBatch queries;
    queries.eye.resize(kCount), queries.resize_lights(kCount), queries.resize_queries(kCount);
    for (std::uint32_t i = 0; i < kCount; ++i) {
      queries.eye.set(i, random_point(random, 1.2f), random_direction(random), 0, 1e-9f, i);
      queries.light.set(i, random_point(random, 1.2f), Vec3(0), 0, 0, i);
      queries.semantic[i] = static_cast<std::uint8_t>(QuerySemantic::point);
      queries.eye_of[i] = queries.light_of[i] = i;
    }
    RayCounts rays;
    VisibilityCounts counts;
    trying->begin(scope);
    trying->visible(queries, a, rays, counts);
    tracing->visible(queries, b, rays, counts);
    EXPECT_EQ(a, b) << scope;
  }
  EXPECT_NE(said.find("auto:"), std::string::npos) << "it says what it chose";
}

// One cell for everything: the cache is wrong about most queries. A picture of so few tiles that nothing is decided must be exact.
TEST(AutomaticVisibility, IsExactUntilItHasDecided) {
  std::mt19937 random(2);
  const Mesh mesh = triangle_soup(random, 150, 1, 0.3f);
  const auto world = World::build(scene_of(mesh), {}, Context());
  const Context context;
  const auto make = [&](const char* name) {
    const VisibilityInfo& info = find_visibility(name);
    return info.make(world, info.settings, context);
  };
  const auto automatic = make("auto"), exact = make("exact"), cached = make("cached");
  for (const auto& visibility : {automatic.get(), exact.get(), cached.get()}) visibility->begin_pass({}, context);
  const auto trying = automatic->worker(), tracing = exact->worker(), caching = cached->worker();
  constexpr std::size_t kCount = 1024;
  std::vector<float> a(kCount), b(kCount), c(kCount);
  QueryBatch queries;
  queries.eye.resize(kCount), queries.resize_lights(1), queries.resize_queries(kCount);
  queries.light.set(0, Vec3(0), Vec3(0), 0, 0, 0);
  queries.semantic[0] = static_cast<std::uint8_t>(QuerySemantic::point);
  for (std::uint32_t i = 0; i < kCount; ++i) {
    queries.eye.set(i, random_point(random, 1.2f), Vec3(0, 0, 1), 0, 100, i);
    queries.eye_of[i] = i, queries.light_of[i] = 0;
  }
  int as_rays = 0;
  for (std::uint32_t scope = 0; scope < 6; ++scope) {
    RayCounts rays;
    VisibilityCounts counts, others;
    trying->begin(scope);
    as_rays += trying->exact();
    trying->visible(queries, a, rays, counts);
    tracing->visible(queries, b, rays, others);
    EXPECT_EQ(a, b) << scope;
    EXPECT_EQ(counts.queries, kCount);
    EXPECT_GE(counts.traced, kCount) << "rays of the trial count";
  }
  EXPECT_EQ(as_rays, 3) << "half of the scopes are asked as rays trace fastest";
  RayCounts rays;
  VisibilityCounts counts;
  caching->begin(0);
  caching->visible(queries, c, rays, counts);
  EXPECT_NE(c, b) << "or the test says nothing";
}

}  // namespace
}  // namespace sightline::test
