// Shadow maps against geometry whose shadows are known, and against exact rays.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/core/error.h"
#include "base/math/frame.h"
#include "unit/visibility_rivals/rivals_support.h"
#include "visibility/shadow_map/cube_lanes.h"
#include "visibility/shadow_map/depth_map.h"

namespace sightline::test {
namespace {

const std::string kOnDemand = "fill=on-demand";

std::string resolution(int texels) { return "resolution=" + std::to_string(texels); }

/// A floor at height 0 of half width 4, and above it at height 1 a plane that ends at x = 0.
Scene half_plane() {
  Scene scene = scene_of(quad(Vec3(0), {0, 0, 4}, {4, 0, 0}));
  place(scene, quad({-2, 1, 0}, {0, 0, 4}, {2, 0, 0}));
  return scene;
}

std::vector<Question> along_floor(const Vec3& light, QuerySemantic semantic, float from, float to, int count) {
  std::vector<Question> questions;
  for (int i = 0; i < count; ++i) {
    const float x = from + (to - from) * static_cast<float>(i) / static_cast<float>(count - 1);
    questions.push_back({{x, 0, 0.37f * std::sin(static_cast<float>(i))}, {0, 1, 0}, light, semantic});
  }
  return questions;
}

TEST(ShadowMap, TheEdgeOfAPointLightsShadowIsWithinHalfATexel) {
  const Vec3 light(0.3f, 2, 0.1f);
  const auto world = World::build(with_light(half_plane(), PointLight{light}), {}, Context());
  for (const int texels : {128, 512, 1000}) {
    const auto maps = make_visibility("shadow-map", world, {resolution(texels), kOnDemand});
    const auto questions = along_floor(light, QuerySemantic::point, -0.5f, -0.1f, 4001);
    const Answers answers = ask(*maps, questions);
    const float edge = -light.x, texel = 2 * light.y / static_cast<float>(texels);
    int lit = 0;
    for (std::size_t i = 0; i < questions.size(); ++i) {
      if (std::fabs(questions[i].x.x - edge) > 0.52f * texel) {
        EXPECT_EQ(answers.weights[i], questions[i].x.x > edge ? 1 : 0) << questions[i].x.x << " at " << texels;
      }
      lit += answers.weights[i] > 0;
    }
    EXPECT_NEAR(lit, 2000, 4001 * 0.52f * texel / 0.4f);
    EXPECT_EQ(answers.counts.traced, 0u);
    EXPECT_EQ(answers.counts.cached, questions.size());
  }
}

TEST(ShadowMap, TheEdgeOfADirectionalLightsShadowIsWithinATexel) {
  const Vec3 travel = glm::normalize(Vec3(0.4f, -1, 0.2f));
  const auto world = World::build(with_light(half_plane(), DirectionalLight{travel}), {}, Context());
  for (const int texels : {128, 1024}) {
    const auto maps = make_visibility("shadow-map", world, {resolution(texels), kOnDemand});
    const auto questions = along_floor(Vec3(0) - glm::normalize(travel), QuerySemantic::direction, 0.f, 0.8f, 4001);
    const Answers answers = ask(*maps, questions);
    // The map spans at most the diagonal of the floor; its texels lie askew to the edge, and the floor leans.
    const float edge = 0.4f, texel = 8 * std::sqrt(2.f) / static_cast<float>(texels);
    for (std::size_t i = 0; i < questions.size(); ++i) {
      if (std::fabs(questions[i].x.x - edge) > texel) {
        EXPECT_EQ(answers.weights[i], questions[i].x.x > edge ? 1 : 0) << questions[i].x.x << " at " << texels;
      }
    }
    EXPECT_EQ(answers.counts.traced, 0u);
  }
}

// Sizes from a millimetre to ten kilometres.
class ShadowMapOfSize : public testing::TestWithParam<float> {};
INSTANTIATE_TEST_SUITE_P(Sizes, ShadowMapOfSize, testing::Values(1e-3f, 1.f, 1e4f));

TEST_P(ShadowMapOfSize, ALitPlaneDoesNotShadowItself) {
  const float size = GetParam();
  const Vec3 normal = glm::normalize(Vec3(0.3f, 1, -0.4f));
  const Frame3 frame = frame_from_normal(normal);
  const Vec3 light = size * Vec3(0.2f, 1.5f, 0.1f), travel = glm::normalize(Vec3(0.5f, -0.8f, 0.1f));
  Scene scene = scene_of(quad(Vec3(0), size * frame.tangent, size * frame.bitangent));
  const auto world = World::build(with_light(with_light(std::move(scene), PointLight{light}), DirectionalLight{travel}), {}, Context());
  const auto maps = make_visibility("shadow-map", world, {resolution(256), kOnDemand});
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(-0.999f, 0.999f);
  std::vector<Question> questions;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 x = size * (unit(random) * frame.tangent + unit(random) * frame.bitangent);
    questions.push_back({x, normal, light, QuerySemantic::point});
    questions.push_back({x, normal, Vec3(0) - travel, QuerySemantic::direction});
  }
  const Answers answers = ask(*maps, questions);
  EXPECT_EQ(answers.mean(), 1);
  EXPECT_EQ(answers.counts.traced, 0u);
}

TEST_P(ShadowMapOfSize, ASphereIsLitInFrontAndDarkBehind) {
  const float size = GetParam();
  const Vec3 light = size * Vec3(0.5f, 3, 1), travel = glm::normalize(Vec3(-0.5f, -0.8f, 0.1f));
  Scene scene;
  Sphere sphere;
  sphere.center = Vec3(0), sphere.radius = size;
  scene.spheres.push_back(sphere);
  const auto world = World::build(with_light(with_light(std::move(scene), PointLight{light}), DirectionalLight{travel}), {}, Context());
  const auto maps = make_visibility("shadow-map", world, {resolution(512), kOnDemand});
  std::mt19937 random(2);
  std::vector<Question> questions;
  std::vector<float> cosines;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 n = random_direction(random);
    const bool point = i % 2 == 0;
    questions.push_back({size * n, n, point ? light : Vec3(0) - travel, point ? QuerySemantic::point : QuerySemantic::direction});
    cosines.push_back(glm::dot(n, point ? glm::normalize(light - size * n) : -travel));
  }
  const Answers answers = ask(*maps, questions);
  int wrong = 0, behind = 0;
  for (std::size_t i = 0; i < questions.size(); ++i) {
    // Near the terminator neither the bias nor the light is worth anything.
    if (cosines[i] > 0.01f) {
      EXPECT_EQ(answers.weights[i], 1) << "cosine " << cosines[i];
    }
    if (cosines[i] < -0.15f) ++behind, wrong += answers.weights[i] != 0;
  }
  EXPECT_EQ(wrong, 0) << "of " << behind;
}

TEST(ShadowMap, AllIsLitWhereNothingIsInTheWayAndDarkWhereEverythingIs) {
  const Vec3 light(0, 3, 0);
  std::mt19937 random(3);
  std::vector<Question> questions;
  for (int i = 0; i < 5000; ++i) {
    const Vec3 p = random_point(random, 0.9f);
    questions.push_back({{p.x, 0, p.z}, {0, 1, 0}, light, QuerySemantic::point});
    questions.push_back({{p.x, 0, p.z}, {0, 1, 0}, {0, 1, 0}, QuerySemantic::direction});
  }
  const auto lights = [&](Scene scene) {
    return with_light(with_light(std::move(scene), PointLight{light}), DirectionalLight{{0, -1, 0}});
  };
  Scene lit = scene_of(quad(Vec3(0), {0, 0, 1}, {1, 0, 0}));
  Scene dark = lit;
  place(dark, quad({0, 1, 0}, {0, 0, 9}, {9, 0, 0}));
  for (const std::string fill : {"whole", "on-demand"}) {
    const auto open = make_visibility("shadow-map", World::build(lights(lit), {}, Context()), {resolution(64), "fill=" + fill});
    open->begin_pass({}, Context());
    EXPECT_EQ(ask(*open, questions).mean(), 1);
    const auto covered = make_visibility("shadow-map", World::build(lights(dark), {}, Context()), {resolution(64), "fill=" + fill});
    covered->begin_pass({}, Context());
    EXPECT_EQ(ask(*covered, questions).mean(), 0);
  }
}

/// A floor below loose triangles, a point light and a sun above, and points of the floor that ask about both.
struct Litter {
  Vec3 light{0.2f, 4, -0.3f}, sun = glm::normalize(Vec3(0.3f, 1, 0.2f));
  std::shared_ptr<const World> world;
  std::vector<Question> questions;

  Litter() {
    std::mt19937 random(4);
    Scene scene = scene_of(triangle_soup(random, 60, 1, 0.4f));
    place(scene, quad({0, -1.5f, 0}, {0, 0, 3}, {3, 0, 0}));
    world = World::build(with_light(with_light(std::move(scene), PointLight{light}), DirectionalLight{-sun}), {}, Context());
    for (int i = 0; i < 20000; ++i) {
      const Vec3 p = random_point(random, 1.5f);
      questions.push_back({{p.x, -1.5f, p.z}, {0, 1, 0}, light, QuerySemantic::point});
      questions.push_back({{p.x, -1.5f, p.z}, {0, 1, 0}, Vec3(0) - glm::normalize(-sun), QuerySemantic::direction});
    }
  }
};

TEST(ShadowMap, FinerMapsAreNearerToTheTruth) {
  const Litter litter;
  const Answers truth = ask(*make_visibility("exact", litter.world), litter.questions);
  ASSERT_GT(truth.mean(), 0.2);
  ASSERT_LT(truth.mean(), 0.9);
  int before = static_cast<int>(litter.questions.size()) / 3;
  for (const int texels : {64, 256, 1024}) {
    const Answers answers = ask(*make_visibility("shadow-map", litter.world, {resolution(texels), kOnDemand}), litter.questions);
    EXPECT_EQ(answers.counts.traced, 0u);
    const int wrong = differences(answers.weights, truth.weights);
    EXPECT_LT(wrong, 0.45 * before) << texels;
    before = wrong;
  }
  EXPECT_LT(before, 0.015 * static_cast<double>(litter.questions.size()));
}

TEST(ShadowMap, WhenAndByHowManyThreadsMapsAreFilledDoesNotShow) {
  const Litter litter;
  const Answers on_demand = ask(*make_visibility("shadow-map", litter.world, {resolution(200), kOnDemand}), litter.questions);
  EXPECT_GT(on_demand.counts.filling, 0u);
  EXPECT_EQ(on_demand.counts.filling, on_demand.rays.closest);
  for (const int threads : {1, 3}) {
    Context context;
    context.threads = threads;
    const auto whole = make_visibility("shadow-map", litter.world, {resolution(200), "fill=whole"});
    whole->begin_pass({}, context);
    const Answers answers = ask(*whole, litter.questions);
    EXPECT_EQ(differences(answers.weights, on_demand.weights), 0);
    // Six faces and one directional map, each texel once; the second pass fills nothing.
    EXPECT_EQ(answers.counts.filling, 7u * 200 * 200);
    EXPECT_GT(answers.counts.filling, on_demand.counts.filling);
    EXPECT_GT(answers.counts.filling_seconds, 0);
    whole->begin_pass({1, 0}, context);
    EXPECT_EQ(ask(*whole, litter.questions).counts.filling, 0u);
    EXPECT_EQ(whole->memory_bytes(), 7u * 224 * 224 * sizeof(float));
  }
}

TEST(ShadowMap, LightsWithoutAMapAreAskedWithRays) {
  const Litter litter;
  std::mt19937 random(6);
  std::vector<Question> questions;
  for (int i = 0; i < 3000; ++i) {
    const std::array semantics{QuerySemantic::surface, QuerySemantic::solid_angle, QuerySemantic::point, QuerySemantic::direction};
    const QuerySemantic semantic = semantics[static_cast<std::size_t>(i) % 4];
    questions.push_back(
        {random_point(random, 1), Vec3(0), is_infinite(semantic) ? random_direction(random) : random_point(random, 2), semantic});
  }
  const Answers truth = ask(*make_visibility("exact", litter.world), questions);
  const Answers answers = ask(*make_visibility("shadow-map", litter.world), questions);
  EXPECT_EQ(differences(answers.weights, truth.weights), 0);
  EXPECT_EQ(answers.counts.traced, questions.size());
  EXPECT_EQ(answers.counts.queries, questions.size());
  EXPECT_EQ(answers.counts.filling, 0u);
}

TEST(ShadowMap, WhatDoesNotFitInMemoryIsAnError) {
  const Litter litter;
  const VisibilityInfo& info = find_visibility("shadow-map");
  SettingsValue settings = info.settings;
  settings.apply("resolution=4096");
  Context context;
  context.memory_budget_bytes = 1u << 20;  // less than the program itself: nothing may be added, whatever ran before
  settings.apply("fill=whole");
  EXPECT_THROW(info.make(litter.world, settings, context), Error);
  settings.apply("fill=automatic");
  const auto maps = info.make(litter.world, settings, context);
  maps->begin_pass({}, context);
  EXPECT_THROW(ask(*maps, litter.questions), Error);
}

TEST(ShadowMap, LanesFindTheTexelsThatTheScalarDefinitionFinds) {
  std::mt19937 random(7);
  const Vec3 center(0.1f, -2, 3);
  const DepthMap map = DepthMap::around(center, 1000);
  CubeLanes lanes{};
  for (int round = 0; round < 200; ++round) {
    std::array<Vec3, CubeLanes::kSize> points, normals;
    for (std::size_t i = 0; i < CubeLanes::kSize; ++i) {
      Vec3 offset = random_point(random, 4);
      // Exactly on axes, diagonals and the light, too.
      if (i % 8 == 1) offset = Vec3(0, offset.y, 0);
      if (i % 8 == 2) offset = Vec3(offset.x, -offset.x, offset.x);
      if (i % 32 == 3) offset = Vec3(0);
      points[i] = center + offset;
      normals[i] = i % 8 == 4 ? Vec3(0) : i % 8 == 5 ? glm::normalize(points[i] - center) : random_direction(random);
      const Vec3 d = points[i] - center;
      lanes.x[i] = d.x, lanes.y[i] = d.y, lanes.z[i] = d.z;
      lanes.nx[i] = normals[i].x, lanes.ny[i] = normals[i].y, lanes.nz[i] = normals[i].z;
    }
    lanes.locate(map.resolution(), map.tiles_across());
    for (std::size_t i = 0; i < CubeLanes::kSize; ++i) {
      const DepthMap::Place place = map.locate(points[i], normals[i]);
      EXPECT_EQ(lanes.texel[i], place.texel);
      EXPECT_FLOAT_EQ(lanes.distance[i], place.distance);
      EXPECT_NEAR(lanes.change[i], place.change, 2e-3 * place.change + 1e-6);
    }
  }
}

TEST(ShadowMap, PlacesThatAreNotNumbersStayInsideTheMap) {
  const Litter litter;
  const float nan = std::numeric_limits<float>::quiet_NaN(), huge = std::numeric_limits<float>::max();
  std::vector<Question> questions;
  for (const Vec3& x : {Vec3(nan), Vec3(huge), Vec3(-huge), litter.light, Vec3(nan, 0, 0), Vec3(0, -huge, huge)}) {
    questions.push_back({x, {0, 1, 0}, litter.light, QuerySemantic::point});
    questions.push_back({x, {0, 1, 0}, Vec3(0) - glm::normalize(-litter.sun), QuerySemantic::direction});
  }
  for (const float weight : ask(*make_visibility("shadow-map", litter.world, {resolution(64), kOnDemand}), questions).weights)
    EXPECT_TRUE(weight == 0 || weight == 1);
}

}  // namespace
}  // namespace sightline::test
