// Animation channels reach the nodes they move.
#include <gtest/gtest.h>

#include "gltf_file.h"

namespace sightline::test {
namespace {

/// A triangle on node 0 and an animation of its translation from (0,0,0) at 1 s to (2,0,0) at 3 s.
GltfFile moving_triangle() {
  GltfFile file;
  file.add_root({{"mesh", file.add_mesh({{"attributes", {{"POSITION", file.add_triangle_positions()}}}})}});
  const int times = file.add_array<float>({1, 3}, kFloat, 2, "SCALAR");
  const int values = file.add_array<float>({0, 0, 0, 2, 0, 0}, kFloat, 2, "VEC3");
  file.push("animations", {{"samplers", {{{"input", times}, {"output", values}}}},
                           {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}});
  return file;
}

float x_at(const Scene& scene, float time_s) { return pose(scene, time_s).instances.at(0).world_from_object[3].x; }

TEST(GltfAnimation, MovesInstancesAndClampsAtTheEnds) {
  const Scene scene = moving_triangle().load();
  EXPECT_FLOAT_EQ(scene.animation_duration_s, 3);
  EXPECT_FLOAT_EQ(x_at(scene, 0), 0);
  EXPECT_FLOAT_EQ(x_at(scene, 1.5f), 0.5f);
  EXPECT_FLOAT_EQ(x_at(scene, 2.5f), 1.5f);
  EXPECT_FLOAT_EQ(x_at(scene, 99), 2);
}

TEST(GltfAnimation, StepHoldsTheLastKey) {
  GltfFile file = moving_triangle();
  file.json["animations"][0]["samplers"][0]["interpolation"] = "STEP";
  const Scene scene = file.load();
  EXPECT_FLOAT_EQ(x_at(scene, 2.9f), 0);
  EXPECT_FLOAT_EQ(x_at(scene, 3), 2);
}

TEST(GltfAnimation, ChildrenFollow) {
  GltfFile file = moving_triangle();
  file.json["nodes"][0]["children"] = {1};
  file.push("nodes", {{"mesh", 0}, {"translation", {0, 5, 0}}});
  const Scene scene = pose(file.load(), 3);
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(transform_point(scene.instances[1].world_from_object, Vec3(0)), Vec3(2, 5, 0));
}

TEST(GltfAnimation, NormalisedRotationsAreRead) {
  GltfFile file = moving_triangle();
  const int values = file.add_array<std::int16_t>({0, 0, 0, 32767, 0, 0, 32767, 0}, kShort, 2, "VEC4", true);
  file.json["animations"][0]["samplers"][0]["output"] = values;
  file.json["animations"][0]["channels"][0]["target"]["path"] = "rotation";
  const Scene scene = pose(file.load(), 2);
  // Half of a half turn about +Z.
  const Vec3 x = transform_vector(scene.instances.at(0).world_from_object, Vec3(1, 0, 0));
  EXPECT_NEAR(x.x, 0, 1e-6f);
  EXPECT_NEAR(x.y, 1, 1e-6f);
}

TEST(GltfAnimation, CubicSplinesHaveThreeValuesAKey) {
  GltfFile file = moving_triangle();
  file.json["animations"][0]["samplers"][0]["interpolation"] = "CUBICSPLINE";
  EXPECT_NE(error_of(file).find("/animations/0/samplers/0/output"), std::string::npos) << error_of(file);
  file.json["animations"][0]["samplers"][0]["output"] =
      file.add_array<float>({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0}, kFloat, 6, "VEC3");
  const Scene scene = file.load();
  // With zero tangents the spline is 3t² - 2t³ of the way.
  EXPECT_NEAR(x_at(scene, 1.5f), 2 * (3.f / 16 - 2.f / 64), 1e-6f);
}

TEST(GltfAnimation, SeveralAnimationsPlayTogetherWithAWarning) {
  GltfFile file = moving_triangle();
  file.json["animations"].push_back(file.json["animations"][0]);
  const int scales = file.add_array<float>({1, 1, 1, 4, 4, 4}, kFloat, 2, "VEC3");
  file.json["animations"][1]["samplers"][0]["output"] = scales;
  file.json["animations"][1]["channels"].push_back({{"sampler", 0}, {"target", {{"node", 0}, {"path", "scale"}}}});
  const Scene scene = file.load();
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("2 animations"), std::string::npos);
  EXPECT_FLOAT_EQ(x_at(scene, 3), 2) << "the first animation keeps the translation";
  EXPECT_FLOAT_EQ(pose(scene, 3).instances[0].world_from_object[1].y, 4);
}

TEST(GltfAnimation, WeightsOfAMeshWithoutTargetsAreIgnoredWithAWarning) {
  GltfFile file = moving_triangle();
  file.json["animations"][0]["channels"][0]["target"]["path"] = "weights";
  const Scene scene = file.load();
  EXPECT_EQ(scene.warnings.size(), 1u);
  EXPECT_EQ(scene.animation_duration_s, 0);
}

TEST(GltfAnimation, TimesMustIncrease) {
  GltfFile file = moving_triangle();
  file.json["animations"][0]["samplers"][0]["input"] = file.add_array<float>({3, 1}, kFloat, 2, "SCALAR");
  EXPECT_NE(error_of(file).find("/animations/0/samplers/0/input"), std::string::npos) << error_of(file);
}

}  // namespace
}  // namespace sightline::test
