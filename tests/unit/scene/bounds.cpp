#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "scene/scene.h"

namespace sightline {
namespace {

/// A tetrahedron-like mesh whose box has corners that are no vertices.
Mesh make_mesh() {
  Mesh mesh;
  mesh.positions = std::vector<Vec3>{{-1, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = std::vector<UVec3>{{0, 1, 2}, {0, 2, 3}};
  mesh.bounds = {{-1, 0, 0}, {1, 1, 1}};
  return mesh;
}

TEST(SceneBounds, AreThoseOfTheTransformedVertices) {
  Scene scene;
  scene.meshes.push_back(make_mesh());
  const Mat4 turn = glm::rotate(Mat4(1), 0.7f, glm::normalize(Vec3(1, 2, 3)));
  scene.instances.push_back({.mesh = MeshId(0), .world_from_object = turn});
  Bounds expected;
  for (const Vec3& p : scene.meshes[0].positions) expected.add(transform_point(turn, p));
  EXPECT_EQ(scene_bounds(scene).lower, expected.lower);
  EXPECT_EQ(scene_bounds(scene).upper, expected.upper);
}

TEST(SceneBounds, CountSpheresAndIgnoreMissingMeshes) {
  Scene scene;
  scene.instances.push_back({.mesh = MeshId(3)});
  EXPECT_TRUE(scene_bounds(scene).is_empty());
  scene.spheres.push_back({.center = {1, 2, 3}, .radius = 2});
  EXPECT_EQ(scene_bounds(scene).lower, Vec3(-1, 0, 1));
}

TEST(SceneCounts, InstancesCountEachTimeAndSharedArraysOnce) {
  Scene scene;
  scene.meshes.push_back(make_mesh());
  scene.meshes.push_back(scene.meshes[0]);
  for (int i = 0; i < 5; ++i) scene.instances.push_back({.mesh = MeshId(0)});
  EXPECT_EQ(instanced_triangle_count(scene), 10u);
  EXPECT_EQ(scene_bytes(scene), 4 * sizeof(Vec3) + 2 * sizeof(UVec3));
}

TEST(FramingCamera, SeesTheWholeBoxFromTheAgreedDirection) {
  const Bounds bounds{{-3, 1, -1}, {5, 2, 4}};
  const Camera camera = framing_camera(bounds);
  const Vec3 eye = Vec3(camera.world_from_camera[3]), backwards = Vec3(camera.world_from_camera[2]);
  const Vec3 expected = glm::normalize(Vec3(1, 0.6f, 1));
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(backwards[i], expected[i], 1e-6f);
  EXPECT_NEAR(glm::length(eye - bounds.center()), bounds.half_diagonal() / std::sin(20 * kPi / 180), 1e-4f);
  EXPECT_EQ(camera.fov_axis, Camera::FovAxis::shorter);
  EXPECT_FLOAT_EQ(camera.fov_rad, 40 * kPi / 180);
  EXPECT_NEAR(glm::determinant(Mat3(camera.world_from_camera)), 1, 1e-5f);
  EXPECT_GT(camera.world_from_camera[1].y, 0) << "+Y is up";
  // Every corner lies within the half angle of 20 degrees of the axis.
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p{corner & 1 ? 5 : -3, corner & 2 ? 2 : 1, corner & 4 ? 4 : -1};
    EXPECT_GE(glm::dot(glm::normalize(p - eye), -backwards), std::cos(20.001f * kPi / 180));
  }
}

TEST(FramingCamera, IsSaneForNothingAndForAPoint) {
  EXPECT_TRUE(is_finite(Vec3(framing_camera(Bounds{}).world_from_camera[3])));
  EXPECT_TRUE(is_finite(Vec3(framing_camera(Bounds{Vec3(2), Vec3(2)}).world_from_camera[3])));
}

}  // namespace
}  // namespace sightline
