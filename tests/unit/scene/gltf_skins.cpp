// Skins and morph targets: what files say, and where vertices are at a time.
#include <gtest/gtest.h>

#include <cmath>

#include "gltf_file.h"
#include "scene/deform.h"

namespace sightline::test {
namespace {

constexpr float kHalf = 0.70710678f;

/// A triangle of which vertex 0 hangs on joint 0 (at rest in the origin), vertex 1 on joint 1 (at rest in (1, 0, 0)) and vertex 2 on both
/// equally. Joint 1 turns from 0 to a quarter about +Z within 2 s. The node of the mesh stands elsewhere, which must not matter.
GltfFile skinned_triangle(bool bytes = false) {
  GltfFile file;
  const int normals = file.add_array<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, kFloat, 3, "VEC3");
  const int joints = bytes ? file.add_array<std::uint8_t>({0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}, kUnsignedByte, 3, "VEC4")
                           : file.add_array<std::uint16_t>({0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}, kUnsignedShort, 3, "VEC4");
  const int weights = bytes ? file.add_array<std::uint8_t>({255, 0, 0, 0, 255, 0, 0, 0, 128, 128, 0, 0}, kUnsignedByte, 3, "VEC4", true)
                            : file.add_array<float>({1, 0, 0, 0, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0}, kFloat, 3, "VEC4");
  const int mesh = file.add_mesh(
      {{"attributes", {{"POSITION", file.add_triangle_positions()}, {"NORMAL", normals}, {"JOINTS_0", joints}, {"WEIGHTS_0", weights}}}});
  file.add_root({{"mesh", mesh}, {"skin", 0}, {"translation", {7, 8, 9}}});
  file.add_root({{"children", {2}}});
  file.push("nodes", {{"translation", {1, 0, 0}}});
  const int inverse = file.add_array<float>({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,  0, 0, 1,  //
                                             1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1},
                                            kFloat, 2, "MAT4");
  file.push("skins", {{"joints", {1, 2}}, {"inverseBindMatrices", inverse}, {"name", "arm"}});
  const int times = file.add_array<float>({0, 2}, kFloat, 2, "SCALAR");
  const int values = file.add_array<float>({0, 0, 0, 1, 0, 0, kHalf, kHalf}, kFloat, 2, "VEC4");
  file.push("animations", {{"samplers", {{{"input", times}, {"output", values}}}},
                           {"channels", {{{"sampler", 0}, {"target", {{"node", 2}, {"path", "rotation"}}}}}}});
  return file;
}

void expect_vertex(const Vec3& a, const Vec3& b, float tolerance = 1e-5f) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(GltfSkins, JointsCarryVerticesAndTheNodeDoesNot) {
  for (const bool bytes : {false, true}) {
    const Scene scene = skinned_triangle(bytes).load();
    EXPECT_TRUE(scene.warnings.empty());
    ASSERT_EQ(scene.instances.size(), 1u);
    EXPECT_EQ(scene.instances[0].world_from_object, Mat4(1));
    EXPECT_FALSE(scene.instances[0].node.valid());
    ASSERT_TRUE(scene.meshes.at(0).is_deformable());
    EXPECT_EQ(scene.skins.at(0).name, "arm");
    const Scene rest = pose(scene, 0), bent = pose(scene, 2);
    expect_vertex(rest.meshes[0].positions[1], {1, 0, 0});
    // Vertex 1 is at the joint that turns; vertex 2, at rest in (0, 1, 0) = joint 1 + (-1, 1, 0), goes with half its weight to
    // (1, 0, 0) + (-1, -1, 0), so that the mean with its place at rest is the origin.
    expect_vertex(bent.meshes[0].positions[0], {0, 0, 0});
    expect_vertex(bent.meshes[0].positions[1], {1, 0, 0});
    expect_vertex(bent.meshes[0].positions[2], {0, 0, 0});
    expect_vertex(bent.meshes[0].normals[2], {0, 0, 1});
    expect_vertex(bent.meshes[0].bounds.upper, {1, 0, 0});
    // Posing a posed scene again is posing the first one.
    expect_vertex(pose(bent, 0).meshes[0].positions[2], {0, 1, 0});
  }
}

TEST(GltfSkins, WeightsAreMadeToAddUpAndEmptyOnesHangOnTheFirstJoint) {
  GltfFile file = skinned_triangle();
  const int weights = file.add_array<float>({2, 0, 0, 0, 3, 0, 0, 0, 0, 0, 0, 0}, kFloat, 3, "VEC4");
  file.json["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = weights;
  const Scene bent = pose(file.load(), 2);
  expect_vertex(bent.meshes[0].positions[1], {1, 0, 0});
  expect_vertex(bent.meshes[0].positions[2], {0, 1, 0});
}

TEST(GltfSkins, ASecondSetOfJointsCounts) {
  GltfFile file = skinned_triangle();
  auto& attributes = file.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["WEIGHTS_0"] = file.add_array<float>({1, 0, 0, 0, 1, 0, 0, 0, 0.5f, 0, 0, 0}, kFloat, 3, "VEC4");
  attributes["JOINTS_1"] = file.add_array<std::uint8_t>({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0}, kUnsignedByte, 3, "VEC4");
  attributes["WEIGHTS_1"] = file.add_array<float>({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.5f, 0}, kFloat, 3, "VEC4");
  const Scene scene = file.load();
  EXPECT_EQ(scene.meshes.at(0).deformation->influences, 8u);
  expect_vertex(pose(scene, 2).meshes[0].positions[2], {0, 0, 0});
}

TEST(GltfSkins, NormalsAndTangentsFollowSquashedJoints) {
  // A joint that scales x by 4: normals tilt the other way than tangents, and stay at right angles to the surface.
  Mesh mesh;
  auto deformation = std::make_shared<Deformation>();
  const Vec3 normal = glm::normalize(Vec3(1, 1, 0)), tangent = glm::normalize(Vec3(-1, 1, 0));
  deformation->positions = std::vector<Vec3>{{0, 0, 0}, {-1, 1, 0}, {0, 0, 1}};
  deformation->normals = std::vector<Vec3>(3, normal);
  deformation->tangents = std::vector<Vec4>(3, Vec4(tangent, -1));
  deformation->influences = 1;
  deformation->joints = std::vector<std::uint16_t>(3, 0);
  deformation->joint_weights = std::vector<float>(3, 1);
  mesh.triangles = std::vector<UVec3>{{0, 1, 2}};
  mesh.deformation = deformation;
  for (const float x : {4.f, -4.f}) {
    Mat4 squash(1);
    squash[0].x = x;
    deform(mesh, {}, std::vector<Mat4>{squash});
    const Vec3 winding = glm::cross(mesh.positions[1] - mesh.positions[0], mesh.positions[2] - mesh.positions[0]);
    expect_vertex(mesh.normals[0], glm::normalize(winding));
    expect_vertex(Vec3(mesh.tangents[0]), glm::normalize(Vec3(-x, 1, 0)));
    EXPECT_EQ(mesh.tangents[0].w, -1);
  }
}

TEST(GltfSkins, MergedScenesKeepTheirJoints) {
  Scene scene = skinned_triangle().load();
  merge_into(scene, skinned_triangle().load());
  const Scene bent = pose(scene, 2);
  ASSERT_EQ(bent.meshes.size(), 2u);
  expect_vertex(bent.meshes[1].positions[2], {0, 0, 0});
  scene.nodes[2].rotation_track = {};
  EXPECT_GT(glm::length(pose(scene, 2).meshes[0].positions[2] - bent.meshes[1].positions[2]), 0.5f);
  EXPECT_NE(scene_hash(scene), scene_hash(bent));
}

TEST(GltfSkins, WhatNeverMovesIsNoLongerDeformable) {
  GltfFile file = skinned_triangle();
  file.json.erase("animations");
  file.json["nodes"][2]["rotation"] = {0, 0, kHalf, kHalf};
  const Scene scene = file.load();
  EXPECT_FALSE(scene.meshes.at(0).is_deformable());
  expect_vertex(scene.meshes[0].positions[2], {0, 0, 0});
}

TEST(GltfSkins, TwoNodesBendApart) {
  GltfFile file = skinned_triangle();
  file.add_root({{"mesh", 0}, {"skin", 1}});
  file.push("skins", {{"joints", {1, 1}}});
  file.add_root({{"mesh", 0}, {"translation", {0, 0, 3}}});
  const Scene bent = pose(file.load(), 2);
  ASSERT_EQ(bent.instances.size(), 3u);
  const auto vertex = [&](std::size_t i) {
    return transform_point(bent.instances[i].world_from_object, bent.meshes[bent.instances[i].mesh.index].positions[2]);
  };
  expect_vertex(vertex(0), {0, 0, 0});
  expect_vertex(vertex(1), {0, 1, 0});
  expect_vertex(vertex(2), {0, 1, 3});  // without a skin: as it is, where the node is
}

TEST(GltfSkins, MistakesAreErrorsAtTheirPlace) {
  const auto expect_error = [](const std::function<void(GltfFile&)>& edit, std::string_view place) {
    GltfFile file = skinned_triangle();
    edit(file);
    EXPECT_NE(error_of(file).find(place), std::string::npos) << place << ": " << error_of(file);
  };
  auto attributes = [](GltfFile& f) -> nlohmann::json& { return f.json["meshes"][0]["primitives"][0]["attributes"]; };
  expect_error([](GltfFile& f) { f.json["skins"][0]["joints"] = {1}; }, "/nodes/0");
  expect_error([](GltfFile& f) { f.json["skins"][0]["joints"] = {1, 99}; }, "/skins/0/joints/1");
  expect_error([](GltfFile& f) { f.json["skins"][0]["joints"] = nlohmann::json::array(); }, "/skins/0/joints");
  expect_error([](GltfFile& f) { f.json["nodes"][0]["skin"] = 4; }, "/nodes/0/skin");
  expect_error([](GltfFile& f) { f.json["skins"][0]["joints"] = {1, 2, 2}; }, "/skins/0/inverseBindMatrices");
  expect_error([](GltfFile& f) { f.json["skins"][0]["inverseBindMatrices"] = 0; }, "accessors/0");
  expect_error([&](GltfFile& f) { attributes(f)["JOINTS_0"] = attributes(f)["WEIGHTS_0"]; }, "accessors");
  expect_error([&](GltfFile& f) { attributes(f)["WEIGHTS_0"] = f.add_array<float>({1, 0, 0, 0}, kFloat, 1, "VEC4"); }, "WEIGHTS_0");
  expect_error([&](GltfFile& f) { attributes(f)["WEIGHTS_0"] = attributes(f)["NORMAL"]; }, "accessors");
  expect_error(
      [](GltfFile& f) {
        f.json["skins"][0]["inverseBindMatrices"] = f.add_array<float>(
            {NAN, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1}, kFloat, 2, "MAT4");
      },
      "inverseBindMatrices");
}

TEST(GltfSkins, WhatCannotBendIsShownAtRestWithAWarning) {
  GltfFile file = skinned_triangle();
  file.json["meshes"][0]["primitives"][0]["attributes"].erase("WEIGHTS_0");
  const Scene scene = file.load();
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_EQ(scene.instances.at(0).world_from_object[3].x, 7);

  GltfFile outside = skinned_triangle();
  outside.json["scenes"][0]["nodes"] = {0};
  const Scene alone = outside.load();
  EXPECT_EQ(alone.warnings.size(), 1u);
  EXPECT_FALSE(alone.meshes.at(0).is_deformable());
}

/// Two targets: the first lifts vertex 2 by 1 and tilts its normal, the second moves all by (0, 0, 2).
GltfFile morphing_triangle(const char* interpolation, std::initializer_list<float> values) {
  GltfFile file;
  const int normals = file.add_array<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, kFloat, 3, "VEC3");
  const int lift = file.add_array<float>({0, 0, 0, 0, 0, 0, 0, 1, 0}, kFloat, 3, "VEC3");
  const int tilt = file.add_array<float>({0, 0, 0, 0, 0, 0, 1, 0, 0}, kFloat, 3, "VEC3");
  const int push = file.add_array<float>({0, 0, 2, 0, 0, 2, 0, 0, 2}, kFloat, 3, "VEC3");
  file.push("meshes", {{"primitives",
                        {{{"attributes", {{"POSITION", file.add_triangle_positions()}, {"NORMAL", normals}}},
                          {"targets", {{{"POSITION", lift}, {"NORMAL", tilt}}, {{"POSITION", push}}}}}}},
                       {"weights", {0.25f, 0.5f}}});
  file.add_root({{"mesh", 0}, {"translation", {10, 0, 0}}});
  if (values.size() > 0) {
    const int times = file.add_array<float>({0, 2}, kFloat, 2, "SCALAR");
    const int weights = file.add_accessor(file.add_view(values), kFloat, values.size(), "SCALAR");
    file.push("animations", {{"samplers", {{{"input", times}, {"output", weights}, {"interpolation", interpolation}}}},
                             {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}});
  }
  return file;
}

TEST(GltfMorphs, DefaultWeightsBendMeshesForGood) {
  GltfFile file = morphing_triangle("", {});
  const Scene scene = file.load();
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_FALSE(scene.meshes.at(0).is_deformable());
  expect_vertex(scene.meshes[0].positions[2], {0, 1.25f, 1});
  expect_vertex(scene.meshes[0].normals[2], glm::normalize(Vec3(0.25f, 0, 1)));
  EXPECT_EQ(scene.instances.at(0).world_from_object[3].x, 10);
  // A node's own weights win.
  file.json["nodes"][0]["weights"] = {1, 0};
  expect_vertex(file.load().meshes[0].positions[2], {0, 2, 0});
}

TEST(GltfMorphs, WeightsFollowTheirTrack) {
  const auto vertex = [](const Scene& scene, float time_s) { return pose(scene, time_s).meshes.at(0).positions[2]; };
  const Scene linear = morphing_triangle("LINEAR", {0, 0, 1, 0.5f}).load();
  EXPECT_TRUE(linear.meshes.at(0).is_deformable());
  EXPECT_EQ(linear.animation_duration_s, 2);
  expect_vertex(vertex(linear, 0), {0, 1, 0});
  expect_vertex(vertex(linear, 1), {0, 1.5f, 0.5f});
  expect_vertex(vertex(linear, 9), {0, 2, 1});
  const Scene step = morphing_triangle("STEP", {0, 0, 1, 0.5f}).load();
  expect_vertex(vertex(step, 1.9f), {0, 1, 0});
  // Key 0: in-tangents, values, out-tangents of both targets; then key 1. With zero tangents 3t² - 2t³ of the way; an out-tangent m adds
  // 2 s * (t³ - 2t² + t) m.
  const Scene cubic = morphing_triangle("CUBICSPLINE", {0, 0, 0, 0, 0, 1, 0, 0, 1, 0.5f, 0, 0}).load();
  const float t = 0.25f, smooth = 3 * t * t - 2 * t * t * t, kick = 2 * (t * t * t - 2 * t * t + t);
  expect_vertex(vertex(cubic, 0.5f), {0, 1 + smooth, 2 * (0.5f * smooth + kick)});
  expect_vertex(vertex(cubic, 2), {0, 2, 1});
}

TEST(GltfMorphs, MistakesAreErrorsAtTheirPlace) {
  GltfFile wrong_count = morphing_triangle("LINEAR", {0, 0, 1});
  EXPECT_NE(error_of(wrong_count).find("/animations/0/samplers/0/output"), std::string::npos) << error_of(wrong_count);
  GltfFile weights = morphing_triangle("", {});
  weights.json["nodes"][0]["weights"] = {1};
  EXPECT_NE(error_of(weights).find("/nodes/0/weights"), std::string::npos) << error_of(weights);
  GltfFile size = morphing_triangle("", {});
  size.json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] = size.add_array<float>({1, 2, 3}, kFloat, 1, "VEC3");
  EXPECT_NE(error_of(size).find("targets/0/POSITION"), std::string::npos) << error_of(size);
  GltfFile uneven = morphing_triangle("", {});
  uneven.json["meshes"][0]["primitives"].push_back(
      {{"attributes", uneven.json["meshes"][0]["primitives"][0]["attributes"]}, {"targets", {nlohmann::json::object()}}});
  EXPECT_NE(error_of(uneven).find("equally many"), std::string::npos) << error_of(uneven);
}

TEST(GltfMorphs, MorphsComeBeforeJoints) {
  GltfFile file = skinned_triangle();
  const int push = file.add_array<float>({0, 0, 0, 1, 0, 0, 0, 0, 0}, kFloat, 3, "VEC3");
  file.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", push}}};
  file.json["meshes"][0]["weights"] = {1};
  // Vertex 1 is pushed to joint 1 + (1, 0, 0), which the joint then turns up.
  expect_vertex(pose(file.load(), 2).meshes.at(0).positions[1], {1, 1, 0});
}

}  // namespace
}  // namespace sightline::test
