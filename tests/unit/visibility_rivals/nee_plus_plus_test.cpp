// Next event estimation++: right in the mean, fewer rays, the same for any number of threads.
#include <gtest/gtest.h>

#include <cmath>

#include "base/parallel/parallel.h"
#include "base/sample/sobol.h"
#include "unit/visibility_rivals/rivals_support.h"

namespace sightline::test {
namespace {

/// Two rooms with a wall that has a hole; questions run between points of both and to directions.
struct Rooms {
  std::shared_ptr<const World> world;
  std::vector<Question> questions;

  explicit Rooms(int count = 20000, std::uint32_t seed = 1) {
    Scene scene = scene_of(quad({0, 0, -0.75f}, {0, 1, 0}, {0, 0, 0.55f}));
    place(scene, quad({0, 0, 0.75f}, {0, 1, 0}, {0, 0, 0.55f}));
    place(scene, quad({0, 1.3f, 0}, {2, 0, 0}, {0, 0, 1.3f}));
    place(scene, quad({0, -1.3f, 0}, {2, 0, 0}, {0, 0, 1.3f}));
    world = World::build(std::move(scene), {}, Context());
    std::mt19937 random(seed);
    for (int i = 0; i < count; ++i) {
      const Vec3 a = random_point(random, 1), b = random_point(random, 1);
      Question q;
      q.x = Vec3(-std::fabs(a.x) - 0.05f, a.y, a.z);
      q.y = Vec3(std::fabs(b.x) + 0.05f, b.y, b.z);
      q.semantic = QuerySemantic::surface;
      if (i % 4 == 3) q.y = random_direction(random), q.semantic = QuerySemantic::solid_angle;
      q.id = hash32(seed * 1000003u + static_cast<std::uint32_t>(i));
      questions.push_back(q);
    }
  }
};

// The same questions with other random numbers.
std::vector<Question> reseeded(std::vector<Question> questions, std::uint32_t seed) {
  for (Question& q : questions) q.id = hash_combine(q.id, seed);
  return questions;
}

std::unique_ptr<Visibility> learnt(const Rooms& rooms, const std::vector<std::string>& settings = {"resolution=4"}) {
  auto visibility = make_visibility("nee++", rooms.world, settings);
  visibility->begin_pass({0, 0}, Context());
  ask(*visibility, rooms.questions);
  visibility->begin_pass({1, 0}, Context());
  return visibility;
}

TEST(NeePlusPlus, TheFirstPassIsExact) {
  const Rooms rooms;
  const auto visibility = make_visibility("nee++", rooms.world);
  EXPECT_FALSE(visibility->binary());
  visibility->begin_pass({0, 0}, Context());
  const Answers truth = ask(*make_visibility("exact", rooms.world), rooms.questions);
  const Answers answers = ask(*visibility, rooms.questions);
  EXPECT_EQ(differences(answers.weights, truth.weights), 0);
  EXPECT_EQ(answers.counts.traced, rooms.questions.size());
  EXPECT_EQ(answers.counts.queries, rooms.questions.size());
}

TEST(NeePlusPlus, EveryAnswerIsRightInTheMean) {
  constexpr std::uint32_t kSeeds = 400;
  const Rooms rooms(3000);
  const auto visibility = learnt(rooms, {"resolution=2", "directions=4"});
  const Answers truth = ask(*make_visibility("exact", rooms.world), rooms.questions);
  std::vector<double> sum(truth.weights.size(), 0);
  double traced = 0, total = 0, total_squares = 0;
  for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
    const Answers answers = ask(*visibility, reseeded(rooms.questions, seed));
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += answers.weights[i];
    traced += static_cast<double>(answers.counts.traced);
    total += answers.mean(), total_squares += answers.mean() * answers.mean();
  }
  // Roulette must have had something to do.
  EXPECT_LT(traced, 0.8 * kSeeds * static_cast<double>(rooms.questions.size()));
  // All together: three standard errors.
  const double mean = total / kSeeds, error = std::sqrt((total_squares / kSeeds - mean * mean) / (kSeeds - 1));
  EXPECT_GT(error, 0);
  EXPECT_NEAR(mean, truth.mean(), 3 * error);
  // Each by itself: a weight is at most 20, so 1 / p - 1 <= 19 bounds the variance; 5 standard errors for 3000 of them.
  for (std::size_t i = 0; i < sum.size(); ++i) {
    EXPECT_NEAR(sum[i] / kSeeds, truth.weights[i], truth.weights[i] * 5 * std::sqrt(19.0 / kSeeds)) << i;
  }
}

TEST(NeePlusPlus, AVisibleQueryWherePastOnesWereDarkKeepsItsMean) {
  const auto world = World::build(scene_of(quad(Vec3(0), {0, 1, 0}, {0, 0, 1})), {}, Context());
  const auto visibility = make_visibility("nee++", world, {"resolution=1", "min_probability=0.05"});
  // One voxel: what is learnt behind the quad is believed in front of it.
  ask(*visibility, std::vector<Question>(1000, {{-1, 0, 0}, Vec3(0), {1, 0, 0}, QuerySemantic::point, 0}));
  visibility->begin_pass({1, 0}, Context());
  std::vector<Question> open(200000, {{-1, 0, 0}, Vec3(0), {-1, 2, 0}, QuerySemantic::point, 0});
  for (std::uint32_t i = 0; i < open.size(); ++i) open[i].id = hash32(i);
  const Answers answers = ask(*visibility, open);
  constexpr double kProbability = 13.0 / 256;  // 0.05, rounded up
  EXPECT_NEAR(answers.mean(), 1, 3 * std::sqrt((1 / kProbability - 1) / static_cast<double>(open.size())));
  EXPECT_NEAR(static_cast<double>(answers.counts.traced), kProbability * static_cast<double>(open.size()), 400);
}

TEST(NeePlusPlus, ALightBehindAWallCostsFewRays) {
  Scene scene = scene_of(quad({0, 0, 0}, {0, 2, 0}, {0, 0, 2}));
  place(scene, quad({0, -1, 0}, {1, 0, 0}, {0, 0, 1}));
  const auto world = World::build(std::move(scene), {}, Context());
  std::mt19937 random(3);
  std::vector<Question> questions;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 a = random_point(random, 0.9f);
    // A light in sight and one behind the wall.
    questions.push_back({{-std::fabs(a.x) - 0.05f, a.y, a.z},
                         Vec3(0),
                         {i % 2 ? 0.8f : -0.8f, 0.3f, 0.2f},
                         QuerySemantic::point,
                         hash32(static_cast<std::uint32_t>(i))});
  }
  const auto visibility = make_visibility("nee++", world, {"resolution=8"});
  ask(*visibility, questions);
  visibility->begin_pass({1, 0}, Context());
  const Answers truth = ask(*make_visibility("exact", world), questions), answers = ask(*visibility, questions);
  EXPECT_EQ(truth.mean(), 0.5);
  // Roulette goes on with one in twenty of the dark half where voxels were tested often enough.
  EXPECT_LT(answers.counts.traced, 0.6 * static_cast<double>(questions.size()));
  EXPECT_EQ(answers.counts.traced + answers.counts.cached, questions.size());
  EXPECT_EQ(answers.rays.occlusion, answers.counts.traced);
  EXPECT_EQ(answers.mean(), 0.5) << "what is always or never visible stays exact";
}

TEST(NeePlusPlus, APointThatAsksManyTimesPlaysEachTimeAnew) {
  const auto world = World::build(scene_of(quad(Vec3(0), {0, 1, 0}, {0, 0, 1})), {}, Context());
  const auto visibility = make_visibility("nee++", world, {"resolution=1"});
  ask(*visibility, std::vector<Question>(1000, {{-1, 0, 0}, Vec3(0), {1, 0, 0}, QuerySemantic::point, 0}));
  visibility->begin_pass({1, 0}, Context());
  constexpr std::size_t kTimes = 20000;
  QueryBatch batch = batch_of({{{-1, 0, 0}, Vec3(0), {-1, 2, 0}, QuerySemantic::point, 7}});
  batch.resize_queries(kTimes);
  std::fill_n(batch.eye_of.begin(), kTimes, 0u);
  std::fill_n(batch.light_of.begin(), kTimes, 0u);
  std::vector<float> weights(padded(kTimes));
  RayCounts rays;
  VisibilityCounts counts;
  visibility->worker()->visible(batch, weights, rays, counts);
  const double expected = 13.0 / 256 * kTimes;
  EXPECT_NEAR(static_cast<double>(counts.traced), expected, 5 * std::sqrt(expected));
}

TEST(NeePlusPlus, WhatIsLearntOneWayHoldsTheOtherWay) {
  const Rooms rooms;
  const auto visibility = learnt(rooms, {"resolution=4", "directions=0"});
  std::vector<Question> back;
  for (Question q : rooms.questions) {
    if (q.semantic != QuerySemantic::surface) continue;
    std::swap(q.x, q.y);
    back.push_back(q);
  }
  EXPECT_LT(ask(*visibility, back).counts.traced, 0.9 * static_cast<double>(back.size()));
}

TEST(NeePlusPlus, ThreadsAndTheOrderOfLearningDoNotShow) {
  constexpr std::size_t kPart = 100;
  const Rooms rooms;
  std::vector<float> expected;
  for (const int threads : {1, 2, 7}) {
    Context context;
    context.threads = threads;
    const auto visibility = make_visibility("nee++", rooms.world, {"resolution=4"});
    // Two passes that learn, batches going to whichever thread is free.
    std::vector<float> answers(rooms.questions.size());
    for (std::uint32_t pass = 0; pass < 3; ++pass) {
      visibility->begin_pass({pass, 0}, context);
      parallel_for(context, rooms.questions.size(), kPart, [&](std::size_t begin, std::size_t end) {
        const std::vector<Question> part(rooms.questions.begin() + static_cast<std::ptrdiff_t>(begin),
                                         rooms.questions.begin() + static_cast<std::ptrdiff_t>(end));
        const Answers given = ask(*visibility, reseeded(part, pass));
        std::copy(given.weights.begin(), given.weights.end(), answers.begin() + static_cast<std::ptrdiff_t>(begin));
      });
    }
    if (expected.empty()) expected = answers;
    EXPECT_EQ(differences(answers, expected), 0) << threads;
  }
}

TEST(NeePlusPlus, CoherentBatchesAndGapsGiveTheSameAnswers) {
  const Rooms rooms(2000);
  const auto visibility = learnt(rooms, {"resolution=4", "sure_from=0.3"});
  const Answers expected = ask(*visibility, rooms.questions);
  QueryBatch batch = batch_of(rooms.questions);
  batch.kind = BatchKind::shadow;
  for (std::size_t i = 0; i < batch.size; i += 3) batch.light_of[i] = kNoQuery;
  std::vector<float> weights(padded(batch.size), -1);
  RayCounts rays;
  VisibilityCounts counts;
  visibility->worker()->visible(batch, weights, rays, counts);
  for (std::size_t i = 0; i < batch.size; ++i) EXPECT_EQ(weights[i], i % 3 == 0 ? 0 : expected.weights[i]) << i;
  EXPECT_EQ(counts.queries, batch.size - (batch.size + 2) / 3);
  EXPECT_EQ(rays.occlusion, counts.traced);
}

TEST(NeePlusPlus, WithoutCellsOfDirectionsInfiniteLightsAreAskedWithRays) {
  const Rooms rooms;
  const auto visibility = learnt(rooms, {"resolution=2", "directions=0"});
  std::vector<Question> sky;
  for (const Question& q : rooms.questions) {
    if (q.semantic == QuerySemantic::solid_angle) sky.push_back(q);
  }
  EXPECT_EQ(ask(*visibility, sky).counts.traced, sky.size());
  EXPECT_LT(ask(*learnt(rooms, {"resolution=2", "directions=4"}), sky).counts.traced, sky.size());
}

}  // namespace
}  // namespace sightline::test
