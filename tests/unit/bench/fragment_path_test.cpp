#include "bench/fragments/path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <variant>

namespace sightline {
namespace {

TEST(CourtWalk, BeginsWhereTheViewStands) {
  const CourtWalk walk = court_walk(0, 120);
  EXPECT_EQ(walk.forward, 0);
  EXPECT_EQ(walk.side, 0);
  EXPECT_EQ(walk.turn_rad, 0);
  EXPECT_EQ(walk.light_x, 0);
}

TEST(CourtWalk, GoesAlongTheCourtWhileTheLightGoesFromEndToEnd) {
  constexpr int kFrames = 120;
  float least = 0, most = 0, before = -1;
  for (int frame = 0; frame < kFrames; ++frame) {
    const CourtWalk walk = court_walk(frame, kFrames);
    EXPECT_GT(walk.forward, before);
    before = walk.forward;
    least = std::min(least, walk.light_x), most = std::max(most, walk.light_x);
    EXPECT_LE(std::abs(walk.side), 0.5f + 1e-5f);
  }
  EXPECT_FLOAT_EQ(before, 8);
  EXPECT_NEAR(least, -6, 0.01);
  EXPECT_NEAR(most, 6, 0.01);
}

TEST(CourtWalk, IsAFunctionOfTheFrameAlone) {
  const CourtWalk late = court_walk(77, 120);
  court_walk(3, 120);
  const CourtWalk again = court_walk(77, 120);
  EXPECT_EQ(late.forward, again.forward);
  EXPECT_EQ(late.light_x, again.light_x);
  // One frame alone is the start.
  EXPECT_EQ(court_walk(0, 1).forward, 0);
}

TEST(CourtWalk, TheCameraWalksWhereItLooksAlongTheGround) {
  Camera camera;
  // Looks along +X and down.
  const Vec3 back = glm::normalize(Vec3(-1, 0.5f, 0)), right(0, 0, 1), up = glm::cross(back, right);
  camera.world_from_camera = Mat4(Vec4(right, 0), Vec4(up, 0), Vec4(back, 0), Vec4(1, 2, 3, 1));
  const Camera moved = walked(camera, {.forward = 4, .side = 0.5f}, 2);
  EXPECT_NEAR(moved.world_from_camera[3].x, 9, 1e-5);
  EXPECT_NEAR(moved.world_from_camera[3].y, 2, 1e-5);
  EXPECT_NEAR(moved.world_from_camera[3].z, 4, 1e-5);
  EXPECT_EQ(moved.world_from_camera[2], camera.world_from_camera[2]);
}

TEST(CourtWalk, TurningKeepsTheAxesOrthogonalAndTheHeightOfTheView) {
  Camera camera;
  const Camera moved = walked(camera, {.turn_rad = 0.5f}, 1);
  const Mat4& m = moved.world_from_camera;
  // Counter-clockwise from above: from -Z towards -X.
  EXPECT_NEAR(-m[2].x, -std::sin(0.5f), 1e-6);
  EXPECT_NEAR(-m[2].z, -std::cos(0.5f), 1e-6);
  EXPECT_NEAR(glm::dot(Vec3(m[0]), Vec3(m[2])), 0, 1e-6);
  EXPECT_EQ(m[1], camera.world_from_camera[1]);
}

TEST(CourtWalk, OnlyRectanglesMove) {
  Scene scene;
  EXPECT_FALSE(move_lights(scene, {.light_x = 3}, 2));
  scene.lights = {{"a", PointLight{}, {}}, {"b", RectangleLight{.center = Vec3(1, 2, 3)}, {}}};
  EXPECT_TRUE(move_lights(scene, {.light_x = 3}, 2));
  EXPECT_EQ(std::get<RectangleLight>(scene.lights[1].shape).center, Vec3(7, 2, 3));
  EXPECT_EQ(std::get<PointLight>(scene.lights[0].shape).position, Vec3(0));
}

}  // namespace
}  // namespace sightline
