// The node hierarchy and what hangs on it.
#include <gtest/gtest.h>

#include "gltf_file.h"

namespace sightline::test {
namespace {

void expect_near(const Vec3& a, const Vec3& b, float tolerance = 1e-6f) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << "component " << i;
}

GltfFile file_with_triangle() {
  GltfFile file;
  file.add_mesh({{"attributes", {{"POSITION", file.add_triangle_positions()}}}});
  return file;
}

TEST(GltfNodes, TransformsComposeFromTheRootDown) {
  GltfFile file = file_with_triangle();
  // Parent: a quarter turn about +Z after scaling by 2; child: moved by (1, 0, 0).
  const int child = file.push("nodes", {{"mesh", 0}, {"translation", {1, 0, 0}}});
  file.add_root(
      {{"children", {child}}, {"rotation", {0, 0, std::sqrt(0.5), std::sqrt(0.5)}}, {"scale", {2, 2, 2}}, {"translation", {0, 0, 5}}});
  const Scene scene = file.load();
  ASSERT_EQ(scene.instances.size(), 1u);
  expect_near(transform_point(scene.instances[0].world_from_object, Vec3(0)), Vec3(0, 2, 5));
  expect_near(transform_point(scene.instances[0].world_from_object, Vec3(1, 0, 0)), Vec3(0, 4, 5));
}

TEST(GltfNodes, MatricesAreColumnMajor) {
  GltfFile file = file_with_triangle();
  file.add_root({{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 7, 8, 9, 1}}});
  EXPECT_EQ(transform_point(file.load().instances.at(0).world_from_object, Vec3(0)), Vec3(7, 8, 9));
}

TEST(GltfNodes, ParentsComeBeforeTheirChildren) {
  GltfFile file = file_with_triangle();
  // Index order is children first.
  for (int i = 0; i < 50; ++i) file.push("nodes", {{"mesh", 0}, {"children", nlohmann::json::array()}});
  for (int i = 1; i < 50; ++i) file.json["nodes"][i]["children"].push_back(i - 1);
  file.json["scenes"] = {{{"nodes", {49}}}};
  const Scene scene = file.load();
  ASSERT_EQ(scene.nodes.size(), 50u);
  EXPECT_FALSE(scene.nodes[0].parent.valid());
  for (std::size_t i = 1; i < 50; ++i) EXPECT_EQ(scene.nodes[i].parent.index, i - 1);
}

TEST(GltfNodes, OnlyTheDefaultSceneIsShown) {
  GltfFile file = file_with_triangle();
  file.push("nodes", {{"mesh", 0}, {"translation", {1, 0, 0}}});
  file.push("nodes", {{"mesh", 0}, {"translation", {2, 0, 0}}});
  file.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
  file.json["scene"] = 1;
  const Scene scene = file.load();
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.instances[0].world_from_object[3].x, 2);
}

TEST(GltfNodes, CyclesAndSecondParentsAreErrors) {
  GltfFile loop = file_with_triangle();
  loop.push("nodes", {{"children", {1}}});
  loop.push("nodes", {{"children", {0}}});
  EXPECT_NE(error_of(loop).find("cycle"), std::string::npos) << "without a scene";
  loop.json["scenes"] = {{{"nodes", {0}}}};
  EXPECT_NE(error_of(loop).find("/nodes/1/children/0"), std::string::npos) << error_of(loop);

  GltfFile diamond = file_with_triangle();
  diamond.push("nodes", {{"children", {1, 2}}});
  diamond.push("nodes", {{"children", {3}}});
  diamond.push("nodes", {{"children", {3}}});
  diamond.push("nodes", {{"mesh", 0}});
  diamond.json["scenes"] = {{{"nodes", {0}}}};
  EXPECT_NE(error_of(diamond).find("/nodes/2/children/0"), std::string::npos) << error_of(diamond);
}

TEST(GltfNodes, HierarchiesMayBeDeeperThanTheCallStack) {
  GltfFile file = file_with_triangle();
  constexpr int kDepth = 20000;
  for (int i = 0; i + 1 < kDepth; ++i) file.push("nodes", {{"children", {i + 1}}});
  file.push("nodes", {{"mesh", 0}});
  file.json["scenes"] = {{{"nodes", {0}}}};
  EXPECT_EQ(file.load().nodes.size(), static_cast<std::size_t>(kDepth));
}

TEST(GltfNodes, SingularPlacementsAreLeftOut) {
  GltfFile file = file_with_triangle();
  file.add_root({{"mesh", 0}, {"scale", {1, 0, 1}}});
  file.add_root({{"mesh", 0}, {"scale", {3e38, 3e38, 3e38}}, {"children", {2}}});
  file.push("nodes", {{"mesh", 0}, {"scale", {3e38, 1, 1}}});
  file.add_root({{"mesh", 0}});
  const Scene scene = file.load();
  EXPECT_LE(scene.instances.size(), 2u);
  EXPECT_EQ(scene.warnings.size(), 1u);
}

TEST(GltfNodes, GpuInstancesStandBelowTheirNode) {
  GltfFile file = file_with_triangle();
  const int translations = file.add_array<float>({0, 1, 0, 0, 2, 0}, kFloat, 2, "VEC3");
  const int scales = file.add_array<float>({1, 1, 1, 3, 3, 3}, kFloat, 2, "VEC3");
  file.add_root({{"mesh", 0},
                 {"translation", {10, 0, 0}},
                 {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", translations}, {"SCALE", scales}}}}}}}});
  const Scene scene = file.load();
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(transform_point(scene.instances[0].world_from_object, Vec3(1, 0, 0)), Vec3(11, 1, 0));
  EXPECT_EQ(transform_point(scene.instances[1].world_from_object, Vec3(1, 0, 0)), Vec3(13, 2, 0));
  EXPECT_EQ(scene.nodes.size(), 1u) << "what does not move needs no nodes";

  // The same below a node that moves from x = 10 to x = 20.
  const int times = file.add_array<float>({0, 1}, kFloat, 2, "SCALAR");
  const int values = file.add_array<float>({10, 0, 0, 20, 0, 0}, kFloat, 2, "VEC3");
  file.push("animations", {{"samplers", {{{"input", times}, {"output", values}}}},
                           {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}});
  const Scene moving = pose(file.load(), 1);
  ASSERT_EQ(moving.instances.size(), 2u);
  EXPECT_EQ(transform_point(moving.instances[1].world_from_object, Vec3(1, 0, 0)), Vec3(23, 2, 0));
}

TEST(GltfNodes, CamerasStandWhereTheirNodesDo) {
  GltfFile file = file_with_triangle();
  file.push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.6}, {"znear", 0.1}}}});
  file.push("cameras", {{"type", "orthographic"}, {"orthographic", {{"xmag", 3}, {"ymag", 2}, {"zfar", 10}, {"znear", 0}}}});
  file.add_root({{"camera", 0}, {"translation", {1, 2, 3}}, {"scale", {5, 5, 5}}});
  file.add_root({{"camera", 1}});
  const Scene scene = file.load();
  ASSERT_EQ(scene.cameras.size(), 2u);
  EXPECT_FLOAT_EQ(scene.cameras[0].fov_rad, 0.6f);
  EXPECT_EQ(scene.cameras[0].fov_axis, Camera::FovAxis::vertical);
  EXPECT_EQ(transform_point(scene.cameras[0].world_from_camera, Vec3(0, 0, -1)), Vec3(1, 2, 2)) << "scale does not count";
  EXPECT_EQ(scene.cameras[1].projection, Camera::Projection::orthographic);
  EXPECT_FLOAT_EQ(scene.cameras[1].ortho_height, 4);
}

TEST(GltfNodes, PunctualLightsShineAlongTheirNodesMinusZ) {
  GltfFile file = file_with_triangle();
  file.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"color", {1, 0.5, 0}}, {"intensity", 8}, {"range", 3}},
      {{"type", "directional"}, {"intensity", 3}},
      {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.2}}}}};
  const auto light = [](int i) { return nlohmann::json{{"KHR_lights_punctual", {{"light", i}}}}; };
  file.add_root({{"translation", {1, 2, 3}}, {"extensions", light(0)}});
  file.add_root({{"rotation", {0, std::sqrt(0.5), 0, std::sqrt(0.5)}}, {"extensions", light(1)}});
  file.add_root({{"translation", {0, 4, 0}}, {"extensions", light(2)}});
  const Scene scene = pose(file.load(), 0);
  ASSERT_EQ(scene.lights.size(), 3u);

  const auto& point = std::get<PointLight>(scene.lights[0].shape);
  EXPECT_EQ(point.position, Vec3(1, 2, 3));
  EXPECT_EQ(point.intensity, Color(8, 4, 0));
  const auto& sun = std::get<DirectionalLight>(scene.lights[1].shape);
  expect_near(sun.direction, Vec3(-1, 0, 0));
  EXPECT_EQ(sun.irradiance, Color(3));
  const auto& spot = std::get<SpotLight>(scene.lights[2].shape);
  EXPECT_EQ(spot.position, Vec3(0, 4, 0));
  EXPECT_EQ(spot.direction, Vec3(0, 0, -1));
  EXPECT_FLOAT_EQ(spot.inner_angle_rad, 0.1f);
  EXPECT_FLOAT_EQ(spot.outer_angle_rad, 0.2f);
  EXPECT_EQ(spot.falloff, SpotLight::Falloff::gltf);
}

}  // namespace
}  // namespace sightline::test
