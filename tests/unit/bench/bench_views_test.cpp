#include "bench/bench_views.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "base/core/error.h"

namespace sightline {
namespace {

TEST(BenchViews, ViewsWithoutTheirFilesAreNothing) {
  const std::string empty = testing::TempDir() + "no-such-data";
  for (const char* name : {"sponza-court", "sponza-points", "conference-9", "kitchen-vpl", "staircase", "hairball-open"})
    EXPECT_FALSE(load_bench_view(name, empty, Context())) << name;
}

TEST(BenchViews, UnknownNamesAreAnsweredWithTheNearest) {
  try {
    load_bench_view("sponza-curt", "", Context());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    EXPECT_NE(std::string(error.what()).find("sponza-court"), std::string::npos) << error.what();
  }
}

TEST(BenchViews, ABuiltInSceneIsAViewOfItself) {
  const std::optional<BenchView> view = load_bench_view("builtin:cornell", "", Context());
  ASSERT_TRUE(view);
  EXPECT_EQ(view->name, "builtin:cornell");
  EXPECT_FALSE(view->scene.instances.empty());
}

// Of several folders the first with all files counts.
TEST(BenchViews, PointsAndAreasStandWhereTheListSays) {
  const char* data = std::getenv("SIGHTLINE_DATA");
  if (!data) return;
  const std::string folders = testing::TempDir() + "no-such-data:" + data;
  if (const std::optional<BenchView> view = load_bench_view("sponza-points", folders, Context())) {
    EXPECT_EQ(view->scene.lights.size(), 25u);
    std::size_t low = 0;
    for (const Light& light : view->scene.lights) {
      const auto* point = std::get_if<PointLight>(&light.shape);
      if (!point) continue;
      low += point->position.y == 2.5f;
      EXPECT_LE(std::abs(point->position.x), 14.f);
    }
    EXPECT_EQ(low, 12u);
  }
  if (const std::optional<BenchView> view = load_bench_view("conference-9", folders, Context())) {
    ASSERT_EQ(view->scene.lights.size(), 9u);
    Vec3 sum(0);
    for (const Light& light : view->scene.lights) sum += std::get<RectangleLight>(light.shape).center;
    EXPECT_NEAR(sum.x / 9, 300, 1e-3);
    EXPECT_NEAR(sum.z / 9, -200, 1e-3);
  }
}

TEST(BenchViews, SkiesFrameTheirContentUnderFourEnvironments) {
  for (const char* content : {"bunny", "armadillo", "teapot", "avocado", "duck"}) {
    for (const char* light : {"", "-sun", "-window", "-grace"}) EXPECT_NO_THROW(check_bench_view(std::string(content) + "-sky" + light));
  }
  const char* data = std::getenv("SIGHTLINE_DATA");
  if (!data) return;
  if (const std::optional<BenchView> view = load_bench_view("teapot-sky-grace", data, Context())) {
    ASSERT_TRUE(view->scene.environment);
    EXPECT_EQ(view->scene.environment->mapping, EnvironmentMapping::angular);
    std::size_t vertices = 0;
    for (const Mesh& mesh : view->scene.meshes) {
      if (mesh.name == "ground") continue;
      EXPECT_EQ(mesh.normals.size(), mesh.positions.size());
      vertices += mesh.positions.size();
    }
    EXPECT_GE(vertices, 40000u);
    EXPECT_EQ(view->size_px, IVec2(800, 600));
  }
}

}  // namespace
}  // namespace sightline
