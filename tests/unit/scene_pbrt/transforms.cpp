#include <glm/gtc/matrix_transform.hpp>

#include "unit/scene_pbrt/pbrt_text.h"

namespace sightline {
namespace {

/// Where the triangle's corners (0,0,0), (1,0,0), (0,1,0) go: columns 3, 0 and 1 of the matrix.
void expect_transform(const std::string& directives, const Mat4& expected) {
  const Scene scene = parse_world(directives + kTriangle);
  ASSERT_EQ(scene.meshes.size(), 1u) << directives;
  const Mesh& mesh = scene.meshes[0];
  expect_near(mesh.positions[0], transform_point(expected, {0, 0, 0}));
  expect_near(mesh.positions[1], transform_point(expected, {1, 0, 0}));
  expect_near(mesh.positions[2], transform_point(expected, {0, 1, 0}));
}

TEST(PbrtTransforms, EachDirectiveIsItsMatrix) {
  expect_transform("Translate 1 2 3\n", glm::translate(Mat4(1), Vec3(1, 2, 3)));
  expect_transform("Scale 2 3 4\n", glm::scale(Mat4(1), Vec3(2, 3, 4)));
  expect_transform("Rotate 90 0 0 1\n", Mat4(Vec4(0, 1, 0, 0), Vec4(-1, 0, 0, 0), Vec4(0, 0, 1, 0), Vec4(0, 0, 0, 1)));
  expect_transform("Rotate 30 0 5 0\n", glm::rotate(Mat4(1), glm::radians(30.f), Vec3(0, 1, 0)));
  expect_transform("Transform [0 1 0 0  0 0 1 0  1 0 0 0  7 8 9 1]\n",
                   Mat4(Vec4(0, 1, 0, 0), Vec4(0, 0, 1, 0), Vec4(1, 0, 0, 0), Vec4(7, 8, 9, 1)));
  expect_transform("Translate 5 5 5 Identity\n", Mat4(1));
  expect_transform("Translate 5 5 5 Transform [1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1]\n", Mat4(1));
}

TEST(PbrtTransforms, LaterDirectivesActFirst) {
  expect_transform("Translate 1 0 0 Scale 2 2 2\n", glm::translate(Mat4(1), Vec3(1, 0, 0)) * glm::scale(Mat4(1), Vec3(2)));
  expect_transform("Scale 2 2 2 ConcatTransform [1 0 0 0 0 1 0 0 0 0 1 0 1 0 0 1]\n",
                   glm::scale(Mat4(1), Vec3(2)) * glm::translate(Mat4(1), Vec3(1, 0, 0)));
}

TEST(PbrtTransforms, LookAtIsLeftHandedAndLooksAlongPlusZ) {
  // From (0,0,-5) to the origin with y up, +x stays to the right: a mere translation.
  expect_transform("LookAt 0 0 -5 0 0 0 0 1 0\n", glm::translate(Mat4(1), Vec3(0, 0, 5)));
  // From (5,0,0): the view goes along -x, right = up × forward = y × (-x) = z.
  expect_transform("LookAt 5 0 0 0 0 0 0 1 0\n", Mat4(Vec4(0, 0, -1, 0), Vec4(0, 1, 0, 0), Vec4(1, 0, 0, 0), Vec4(0, 0, 5, 1)));
}

TEST(PbrtTransforms, CoordinateSystemsAreRemembered) {
  expect_transform("Translate 1 2 3 CoordinateSystem \"here\" Scale 9 9 9 CoordSysTransform \"here\"\n",
                   glm::translate(Mat4(1), Vec3(1, 2, 3)));
  const Scene scene =
      parse_text("Translate 0 0 4 Camera \"perspective\" WorldBegin CoordSysTransform \"camera\"\n" + std::string(kTriangle));
  expect_near(scene.meshes[0].positions[0], {0, 0, -4});  // world-from-camera
  EXPECT_TRUE(warns_of(parse_world("CoordSysTransform \"nowhere\"\n"), "test.pbrt:2:1: there is no coordinate system 'nowhere'"));
}

TEST(PbrtTransforms, OnlyTheStateAtTheShutterOpeningCounts) {
  const Scene scene = parse_world("ActiveTransform EndTime Translate 9 9 9 ActiveTransform All Translate 0 0 1\n" + std::string(kTriangle));
  expect_near(scene.meshes[0].positions[0], {0, 0, 1});
  EXPECT_TRUE(warns_of(scene, "motion"));
}

TEST(PbrtTransforms, DegenerateOnesAreErrorsWithPlace) {
  EXPECT_NE(error_of("LookAt 0 0 0 0 1 0 0 1 0 WorldBegin").find("test.pbrt:1:1: LookAt"), std::string::npos);
  EXPECT_NE(error_of("LookAt 1 1 1 1 1 1 0 1 0 WorldBegin").find("LookAt"), std::string::npos);
  EXPECT_NE(error_of("WorldBegin\nScale 1e300 1 1 Scale 1e300 1 1").find("test.pbrt:2:17: the transformation is not finite"),
            std::string::npos);
  EXPECT_NE(error_of("Scale 0 1 1 Camera \"perspective\" WorldBegin").find("cannot be inverted"), std::string::npos);
}

TEST(PbrtTransforms, NormalsGoWithTheInverseTranspose) {
  const Scene scene = parse_world(
      "Scale 1 1 4 Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 -1 0 1 0] \"normal N\" [1 0 1 1 0 1 1 0 1] \"integer indices\" [0 1 "
      "2]\n");
  const Mesh& mesh = scene.meshes[0];
  for (const Vec3& n : mesh.normals) expect_near(n, glm::normalize(Vec3(1, 0, 0.25f)));
  expect_near(face_normal(mesh), glm::normalize(Vec3(1, 0, 0.25f)));
}

TEST(PbrtTransforms, AMirrorKeepsTheNormalOnItsSide) {
  // The vertex order gives +z; mirrored in x the transformed normal is still +z, so the winding must have turned.
  EXPECT_GT(face_normal(parse_world("Scale -1 1 1\n" + std::string(kTriangle)).meshes[0]).z, 0.99f);
  EXPECT_LT(face_normal(parse_world("Scale -1 1 1 ReverseOrientation\n" + std::string(kTriangle)).meshes[0]).z, -0.99f);
  EXPECT_LT(face_normal(parse_world("ReverseOrientation\n" + std::string(kTriangle)).meshes[0]).z, -0.99f);
  EXPECT_LT(face_normal(parse_world("Scale 1 1 -1\n" + std::string(kTriangle)).meshes[0]).z, -0.99f);
}

TEST(PbrtTransforms, ShadingNormalsDecideTheSide) {
  // pbrt turns the geometric normal to the side of the shading normals, whatever the vertex order.
  const std::string shape =
      "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"normal N\" [0 0 -1 0 0 -1 0 0 -1] \"integer indices\" [0 1 2]\n";
  EXPECT_LT(face_normal(parse_world(shape).meshes[0]).z, -0.99f);
  const Scene reversed = parse_world("ReverseOrientation " + shape);
  EXPECT_GT(face_normal(reversed.meshes[0]).z, 0.99f);
  EXPECT_GT(reversed.meshes[0].normals[0].z, 0.99f);
  EXPECT_LT(face_normal(parse_world("Scale -1 1 1 " + shape).meshes[0]).z, -0.99f);
}

}  // namespace
}  // namespace sightline
