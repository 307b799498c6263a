// Maps of the stages, as the setting `show` gives them.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "methods/fragments/stage_map.h"
#include "test_fragments_support.h"

namespace sightline::test {
namespace {

Picture shown(const Shot& shot, std::vector<std::string> settings) {
  return expose(shot, {.method = "fragments", .settings = std::move(settings), .spp = 1, .max_bounces = 0});
}
Shot two_lamps(const IVec2& size) {
  Scene scene = box_on_floor();
  scene.lights.push_back({.name = "second", .shape = lamp({-1.5f, 2.5f, 1}, 0.3f, Color(5)), .node = {}});
  return shot_of(std::move(scene), size);
}

TEST(StageMaps, OfRaysHoldEveryRayThatWasTraced) {
  for (const IVec2 size : {IVec2(150, 101), IVec2(1, 1), IVec2(129, 3)}) {
    const Shot shot = two_lamps(size);
    for (const char* setting : {"variant=sightline", "variant=koa", "variant=nichols", "penumbra_level=1", "confirm=3"}) {
      const Picture picture = shown(shot, {setting, "show=rays"});
      double rays = 0;
      for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(size.x * size.y); ++i) rays += 64.0 * picture.frame.color(i).x;
      const auto traced = static_cast<double>(picture.statistics.rays.occlusion);
      EXPECT_NEAR(rays, traced, 1e-4 * traced + 1e-3) << setting << ", " << size.x << " x " << size.y;
    }
  }
}

TEST(StageMaps, ChangeNothingButWhatIsShown) {
  const Shot shot = two_lamps({150, 101});
  for (const char* variant : {"variant=sightline", "variant=koa", "variant=nichols"}) {
    const Picture picture = shown(shot, {variant});
    for (const char* show : {"show=levels", "show=gradients", "show=rays", "show=signal", "show=curvature"}) {
      const Picture map = shown(shot, {variant, show});
      EXPECT_EQ(map.statistics.method_statistics, picture.statistics.method_statistics) << variant << ", " << show;
      EXPECT_EQ(map.frame.nonfinite_samples(), 0u) << variant << ", " << show;
      EXPECT_FALSE(same_sums(map.frame, picture.frame)) << variant << ", " << show;
    }
  }
}

// With one light: a stable fragment's quadrants differ by less than the threshold, and whoever differed more has been split.
TEST(StageMaps, OfGradientsTellStableFragmentsFromPixels) {
  const Shot shot = shot_of(lamp_over_floor(Occluder::box), {150, 101});
  const std::vector<std::string> plain = {"confirm=0", "borders=0", "dark_culling=off"};
  auto with = [&](const char* show) {
    std::vector<std::string> settings = plain;
    settings.push_back(show);
    return shown(shot, settings);
  };
  const Picture levels = with("show=levels"), gradients = with("show=gradients");
  int steep = 0;
  for (std::uint32_t i = 0; i < 150 * 101; ++i) {
    const double level = 7 * levels.frame.color(i).x, gradient = gradients.frame.color(i).x;
    EXPECT_GE(gradient, 0);
    EXPECT_LE(gradient, 1);
    if (level > 2.5) {
      EXPECT_EQ(gradient, 0) << i;
    } else if (level > 0.5) {
      EXPECT_LE(gradient, 1.0 / 16) << i;
    }
    steep += level < 0.5 && gradient > 0.9 / 16;
  }
  EXPECT_GT(steep, 50);
}

TEST(StageMaps, OfGradientsAreTheSteepestBetweenQuadrantsThatShareAnEdge) {
  EXPECT_EQ(steepest_gradient({0, 0, 0, 0}, 16), 0);
  EXPECT_EQ(steepest_gradient({0xffff, 0, 0, 0}, 16), 1);
  // Top left and bottom right share no edge, but both have neighbours that see nothing.
  EXPECT_EQ(steepest_gradient({0x000f, 0, 0, 0x000f}, 16), 0.25f);
  EXPECT_EQ(steepest_gradient({0x000f, 0x00ff, 0x000f, 0x00ff}, 16), 0.25f);
  EXPECT_EQ(steepest_gradient({0, ~std::uint64_t{0}, 0, 0}, 64), 1);
}

TEST(StageMaps, OfCurvatureAreZeroOnAPlaneAndJumpAtBorders) {
  const Shot floor = shot_of(lamp_over_floor(Occluder::box), {150, 101});
  const Picture plane = shown(floor, {"show=curvature"});
  for (std::uint32_t i = 0; i < 150 * 101; ++i) {
    EXPECT_LT(plane.frame.color(i).x, 1e-4) << i;
    EXPECT_LT(plane.frame.color(i).y, 0.05) << i;
  }
  const Picture box = shown(shot_of(box_on_floor(), {150, 101}), {"show=curvature"});
  int edges = 0, steps = 0;
  for (std::uint32_t i = 0; i < 150 * 101; ++i) edges += box.frame.color(i).x > 1, steps += box.frame.color(i).y > 1;
  EXPECT_GT(edges, 100);
  EXPECT_GT(steps, 100);
  EXPECT_LT(edges, 150 * 101 / 4);
}

}  // namespace
}  // namespace sightline::test
