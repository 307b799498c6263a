#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <random>
#include <vector>

#include "base/core/error.h"
#include "methods/square_lights/hemisphere_disk.h"
#include "methods/square_lights/self_visibility.h"
#include "scene/scene.h"
#include "texture/texture_set.h"

namespace sightline::square_lights {
namespace {

Sphere sphere(const Vec3& center, float radius) {
  Sphere s;
  s.center = center, s.radius = radius;
  return s;
}

/// Spheres, and vertices that look past them.
struct Fixture {
  Context context;
  Scene scene;
  std::vector<Vec3> position, normal, tangent, geometric;
  std::vector<float> error;
  RayCounts rays;

  void add(const Vec3& p, const Vec3& n, const Vec3& t = Vec3(0), std::optional<Vec3> g = {}) {
    position.push_back(p), normal.push_back(glm::normalize(n)), tangent.push_back(t), geometric.push_back(g ? *g : glm::normalize(n));
    error.push_back(1e-6f);
  }
  AlignedVector<std::int8_t> bake(const SelfVisibilityOptions& options = {}) {
    const auto tracer = make_brute_tracer(scene, TextureSet(), {}, context);
    return bake_self_visibility(*tracer, {position, normal, tangent, geometric, error}, options, rays, context);
  }
};
TableView table(const AlignedVector<std::int8_t>& tables, std::size_t i) { return TableView(tables.data() + i * kTableCells, kTableCells); }

TEST(SelfVisibility, OfASphereOverheadIsADisk) {
  Fixture fixture;
  const float radius = 0.5f, distance = 1, edge = std::sqrt(1 - std::cos(std::asin(radius / distance)));
  fixture.scene.spheres.push_back(sphere({0, 0, distance}, radius));
  fixture.add({0, 0, 0}, {0, 0, 1});
  const auto tables = fixture.bake();
  for (float x = 0.1f; x < 0.95f; x += 0.07f) {  // at 0 a cusp is rounded off
    const Vec2 p = x * Vec2(0.8f, -0.6f);
    EXPECT_NEAR(distance_at(table(tables, 0), p), glm::length(p) - edge, 0.03f) << x;
  }
  EXPECT_NEAR(static_cast<float>(fixture.rays.occlusion), kPi * 32 * 32, 20) << "one ray a point of the disk";
}

TEST(SelfVisibility, IsInTheFrameThatItIsReadIn) {
  // Directions to a small sphere are hidden, looked up through vertex_frame() whatever normal and tangent are.
  std::mt19937 random(3);
  std::normal_distribution<float> gauss;
  const auto any = [&] { return glm::normalize(Vec3(gauss(random), gauss(random), gauss(random))); };
  for (int i = 0; i < 30; ++i) {
    Fixture fixture;
    const Vec3 n = any(), t = i % 3 ? any() : Vec3(0);
    Vec3 to = any();
    if (glm::dot(to, n) < 0) to = -to;
    if (glm::dot(to, n) < 0.3f) continue;
    fixture.scene.spheres.push_back(sphere(Vec3(1, 2, 3) + 4.f * to, 0.6f));
    fixture.add({1, 2, 3}, n, t);
    const auto tables = fixture.bake({32, false});
    const auto at = [&](const Vec3& d) { return distance_at(table(tables, 0), disk_from_direction(vertex_frame(n, t).to_local(d))); };
    EXPECT_LT(at(to), -0.03f) << i;
    EXPECT_GT(at(glm::normalize(n + 0.9f * (n - to))), 0.05f) << i;
  }
}

TEST(SelfVisibility, TheHorizonIsNoOccluderUnlessItCounts) {
  Fixture fixture;
  fixture.scene.spheres.push_back(sphere({0, 0, -1}, 0.999f));
  fixture.add({0, 0, 0}, {0, 0, 1});
  const auto tables = fixture.bake({32, false});
  EXPECT_TRUE(std::all_of(tables.begin(), tables.end(), [](std::int8_t code) { return code == 127; }));
  EXPECT_LT(distance_at(table(fixture.bake({32, true}), 0), {0.7f, 0.7f}), 0.05f);
}

TEST(SelfVisibility, BelowTheTrueTangentPlaneIsHiddenWithoutRays) {
  // The geometric normal leans 30 degrees towards +x, so directions with a cosine below 0 to it are hidden.
  Fixture fixture;
  const Vec3 leaning = glm::normalize(Vec3(0.5f, 0, std::sqrt(0.75f)));
  fixture.scene.spheres.push_back(sphere({0, 0, -100}, 1));
  fixture.add({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, leaning);
  const auto tables = fixture.bake();
  const auto at = [&](float angle) { return distance_at(table(tables, 0), disk_from_direction({std::sin(angle), 0, std::cos(angle)})); };
  const float edge = -60 * kPi / 180;
  EXPECT_NEAR(at(edge), 0, 0.03f);
  EXPECT_LT(at(edge - 0.2f), -0.05f);
  EXPECT_GT(at(edge + 0.2f), 0.05f);
  EXPECT_GT(at(1.4f), 1.f);
  EXPECT_LT(fixture.rays.occlusion, 3150u);
}

TEST(SelfVisibility, IsTheSameForAnyNumberOfThreads) {
  std::mt19937 random(5);
  std::normal_distribution<float> gauss;
  Fixture fixture;
  for (int i = 0; i < 5; ++i) fixture.scene.spheres.push_back(sphere(3.f * Vec3(gauss(random), gauss(random), gauss(random)), 0.5f));
  for (int i = 0; i < 200; ++i)
    fixture.add(Vec3(gauss(random), gauss(random), gauss(random)), {gauss(random), gauss(random), gauss(random)});
  fixture.context.threads = 1;
  const auto one = fixture.bake({32, false});
  const RayCounts counted = fixture.rays;
  fixture.context.threads = 3;
  fixture.rays = {};
  EXPECT_EQ(fixture.bake({32, false}), one);
  EXPECT_EQ(fixture.rays.occlusion, counted.occlusion);
}

TEST(SelfVisibility, ReportsProgressKeepsItsAnnouncementAndStops) {
  Fixture fixture;
  fixture.scene.spheres.push_back(sphere({0, 0, 5}, 1));
  for (int i = 0; i < 200; ++i) fixture.add({0, 0, 0}, {0, 0, 1});
  std::atomic<int> reports{0};
  std::atomic<double> most{0};
  fixture.context.progress = [&](const Progress& progress) {
    EXPECT_EQ(progress.phase, "self-visibility");
    EXPECT_EQ(progress.total, 200);
    ++reports;
    most = std::max(most.load(), progress.done);
  };
  const auto tables = fixture.bake({32, false});
  EXPECT_GT(reports, 3);
  EXPECT_EQ(most, 200);
  EXPECT_EQ(tables.size(), 200 * kTableCells);
  EXPECT_LE(tables.capacity(), self_visibility_bytes(200));

  fixture.context.progress = [&](const Progress&) { fixture.context.cancelled = true; };
  EXPECT_THROW(fixture.bake({32, false}), Error);
}

TEST(SelfVisibility, OfNoVerticesIsEmpty) {
  Fixture fixture;
  EXPECT_TRUE(fixture.bake().empty());
}

}  // namespace
}  // namespace sightline::square_lights
