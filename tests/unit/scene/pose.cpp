// Node animation against what can be computed by hand.
#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "scene/scene.h"

namespace sightline {
namespace {

void expect_near(const Vec3& a, const Vec3& b, float tolerance = 2e-6f) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << "component " << i;
}

Vec4 turn_about_z(float angle_rad) { return {0, 0, std::sin(angle_rad / 2), std::cos(angle_rad / 2)}; }

Scene scene_with(Node node) {
  Scene scene;
  scene.nodes.push_back(std::move(node));
  scene.instances.push_back({.mesh = MeshId(0), .node = NodeId(0)});
  return scene;
}

Mat4 matrix_at(const Scene& scene, float time_s) { return pose(scene, time_s).instances[0].world_from_object; }

TEST(Pose, RotationGoesAtConstantSpeedAlongTheArc) {
  Node node;
  node.rotation_track = {.times_s = {0, 2}, .values = {turn_about_z(0), turn_about_z(2.4f)}};
  const Scene scene = scene_with(node);
  for (const float t : {0.f, 0.25f, 1.f, 1.9f, 2.f}) {
    expect_near(transform_vector(matrix_at(scene, t), Vec3(1, 0, 0)), Vec3(std::cos(1.2f * t), std::sin(1.2f * t), 0));
  }
}

TEST(Pose, RotationTakesTheShorterWayWhateverTheSignOfTheQuaternion) {
  Node node;
  node.rotation_track = {.times_s = {0, 1}, .values = {turn_about_z(0), -turn_about_z(0.5f)}};
  expect_near(transform_vector(matrix_at(scene_with(node), 0.5f), Vec3(1, 0, 0)), Vec3(std::cos(0.25f), std::sin(0.25f), 0));
  // Nearly equal keys, where the sine of the angle is too small to divide by.
  node.rotation_track.values[1] = turn_about_z(1e-4f);
  expect_near(transform_vector(matrix_at(scene_with(node), 0.5f), Vec3(1, 0, 0)), Vec3(1, 0.5e-4f, 0), 1e-7f);
}

TEST(Pose, TimesAreClampedAtTheEnds) {
  Node node;
  node.translation_track = {.times_s = {1, 2, 4}, .values = {{1, 0, 0, 0}, {3, 0, 0, 0}, {7, 0, 0, 0}}};
  const Scene scene = scene_with(node);
  EXPECT_EQ(matrix_at(scene, -5)[3].x, 1);
  EXPECT_EQ(matrix_at(scene, 1)[3].x, 1);
  EXPECT_FLOAT_EQ(matrix_at(scene, 1.5f)[3].x, 2);
  EXPECT_EQ(matrix_at(scene, 2)[3].x, 3);
  EXPECT_FLOAT_EQ(matrix_at(scene, 3)[3].x, 5);
  EXPECT_EQ(matrix_at(scene, 100)[3].x, 7);
}

TEST(Pose, CubicSplinesReproduceCubicPolynomials) {
  // x(t) = t³ - 2t with keys at 1, 2, 4 and its own derivative as tangents must come out exactly between the keys.
  const auto x = [](float t) { return t * t * t - 2 * t; };
  const auto dx = [](float t) { return 3 * t * t - 2; };
  Node node;
  node.translation_track.interpolation = Interpolation::cubic_spline;
  for (const float t : {1.f, 2.f, 4.f}) {
    node.translation_track.times_s.push_back(t);
    for (const float value : {dx(t), x(t), dx(t)}) node.translation_track.values.emplace_back(value, 0, 0, 0);
  }
  const Scene scene = scene_with(node);
  for (const float t : {1.f, 1.3f, 2.f, 2.5f, 3.9f, 4.f}) EXPECT_NEAR(matrix_at(scene, t)[3].x, x(t), 1e-4f) << t;
}

TEST(Pose, StepHoldsAndScaleAppliesFirst) {
  Node node;
  node.scale_track = {.interpolation = Interpolation::step, .times_s = {0, 1}, .values = {{2, 3, 4, 0}, {5, 5, 5, 0}}};
  node.rotation = glm::quat(std::cos(kPi / 4), 0, 0, std::sin(kPi / 4));
  node.translation = {10, 0, 0};
  const Scene scene = scene_with(node);
  expect_near(transform_point(matrix_at(scene, 0.99f), Vec3(1, 0, 0)), Vec3(10, 2, 0));
  expect_near(transform_point(matrix_at(scene, 1), Vec3(1, 0, 0)), Vec3(10, 5, 0));
}

TEST(Pose, AnimatedParentsCarryStaticChildren) {
  Scene scene;
  Node parent, child;
  parent.rotation_track = {.times_s = {0, 1}, .values = {turn_about_z(0), turn_about_z(kPi / 2)}};
  child.parent = NodeId(0);
  child.has_matrix = true;
  child.matrix = glm::translate(Mat4(1), Vec3(2, 0, 0));
  scene.nodes = {parent, child};
  scene.instances.push_back({.mesh = MeshId(0), .node = NodeId(1)});
  scene.instances.push_back({.mesh = MeshId(0), .world_from_object = glm::translate(Mat4(1), Vec3(9))});
  expect_near(transform_point(matrix_at(scene, 1), Vec3(0)), Vec3(0, 2, 0));
  EXPECT_EQ(pose(scene, 1).instances[1].world_from_object[3].x, 9) << "what hangs on no node stays";
}

TEST(Pose, LightsFollowTheirNodeAndThenStandInTheWorld) {
  Scene scene;
  Node node;
  node.has_matrix = true;
  node.matrix = glm::translate(Mat4(1), Vec3(0, 5, 0)) * glm::scale(Mat4(1), Vec3(-2, 2, 2));
  scene.nodes.push_back(node);
  scene.lights.push_back({.shape = RectangleLight{}, .node = NodeId(0)});
  scene.lights.push_back({.shape = SphereLight{.radius = 1}, .node = NodeId(0)});
  scene.lights.push_back({.shape = PointLight{.position = {1, 1, 1}}});
  const Scene posed = pose(scene, 0);
  const auto& rectangle = std::get<RectangleLight>(posed.lights[0].shape);
  EXPECT_EQ(rectangle.center, Vec3(0, 5, 0));
  EXPECT_FLOAT_EQ(glm::length(rectangle.half_u), 1);
  EXPECT_GT(glm::cross(rectangle.half_u, rectangle.half_v).z, 0) << "a reflection keeps the side that emits";
  EXPECT_FLOAT_EQ(std::get<SphereLight>(posed.lights[1].shape).radius, 2);
  EXPECT_EQ(std::get<PointLight>(posed.lights[2].shape).position, Vec3(1, 1, 1));
  for (const Light& light : posed.lights) EXPECT_FALSE(light.node.valid());
  EXPECT_EQ(scene_hash(pose(posed, 0)), scene_hash(posed)) << "posing twice changes nothing";
}

TEST(Pose, CamerasKeepUnitAxes) {
  Scene scene;
  Node node;
  node.scale = {3, 3, 3};
  node.translation = {1, 2, 3};
  scene.nodes.push_back(node);
  scene.cameras.push_back({.node = NodeId(0)});
  const Mat4 m = pose(scene, 0).cameras[0].world_from_camera;
  EXPECT_EQ(m, glm::translate(Mat4(1), Vec3(1, 2, 3)));
}

TEST(Pose, TracksWithTooFewValuesAreIgnored) {
  Node node;
  node.translation = {4, 0, 0};
  node.translation_track = {.interpolation = Interpolation::cubic_spline, .times_s = {0, 1}, .values = {Vec4(1), Vec4(1)}};
  EXPECT_EQ(matrix_at(scene_with(node), 0.5f)[3].x, 4);
}

}  // namespace
}  // namespace sightline
