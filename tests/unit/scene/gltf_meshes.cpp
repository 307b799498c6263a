// Primitives become meshes: topologies, attributes, what is dropped and what is shared.
#include <gtest/gtest.h>

#include <limits>

#include "gltf_file.h"

namespace sightline::test {
namespace {

/// Five vertices on a zigzag in the xy plane.
int add_zigzag(GltfFile& file) { return file.add_array<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0}, kFloat, 5, "VEC3"); }

Scene load_primitive(GltfFile& file, nlohmann::json primitive) {
  file.add_root({{"mesh", file.add_mesh(std::move(primitive))}});
  return file.load();
}

Vec3 normal_of(const Mesh& mesh, std::size_t i) {
  const UVec3 t = mesh.triangles[i];
  return glm::normalize(glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]));
}

TEST(GltfMesh, AllTrianglesOfAStripFaceTheSameWay) {
  GltfFile file;
  const Scene scene = load_primitive(file, {{"attributes", {{"POSITION", add_zigzag(file)}}}, {"mode", 5}});
  ASSERT_EQ(scene.meshes.size(), 1u);
  ASSERT_EQ(scene.meshes[0].triangles.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(normal_of(scene.meshes[0], i), Vec3(0, 0, 1)) << i;
}

TEST(GltfMesh, AFanTurnsAroundItsFirstVertex) {
  GltfFile file;
  const int positions = file.add_array<float>({0, 0, 0, 2, 0, 0, 1, 1, 0, -1, 1, 0}, kFloat, 4, "VEC3");
  const Scene scene = load_primitive(file, {{"attributes", {{"POSITION", positions}}}, {"mode", 6}});
  ASSERT_EQ(scene.meshes.size(), 1u);
  ASSERT_EQ(scene.meshes[0].triangles.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(normal_of(scene.meshes[0], i), Vec3(0, 0, 1));
    EXPECT_EQ(scene.meshes[0].triangles[i].z, 0u);
  }
}

TEST(GltfMesh, LinesAndPointsAreLeftOutWithAWarning) {
  for (const int mode : {0, 1, 2, 3}) {
    GltfFile file;
    const Scene scene = load_primitive(file, {{"attributes", {{"POSITION", add_zigzag(file)}}}, {"mode", mode}});
    EXPECT_TRUE(scene.meshes.empty());
    ASSERT_FALSE(scene.warnings.empty());
    EXPECT_NE(scene.warnings[0].find("lines or points"), std::string::npos);
  }
}

TEST(GltfMesh, TrianglesWithWrongIndicesAreDroppedAndCounted) {
  GltfFile file;
  const int indices = file.add_array<std::uint16_t>({0, 1, 2, 0, 1, 77, 1, 1, 2, 2, 1, 3}, kUnsignedShort, 12, "SCALAR");
  const Scene scene = load_primitive(file, {{"attributes", {{"POSITION", add_zigzag(file)}}}, {"indices", indices}});
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes[0].triangles.size(), 2u);
  EXPECT_EQ(scene.dropped_triangles, 2u);
}

TEST(GltfMesh, TrianglesWithBrokenVerticesAreDroppedAndTheVerticesMadeFinite) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();
  GltfFile file;
  const int positions = file.add_array<float>({kNan, 0, 0, 1, 0, 0, 0, 1, 0, 2, 2, 1, kInf, 0, 0}, kFloat, 5, "VEC3");
  const Scene scene = load_primitive(file, {{"attributes", {{"POSITION", positions}}}, {"mode", 5}});
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes[0].triangles.size(), 1u);
  EXPECT_EQ(scene.dropped_triangles, 2u);
  for (const Vec3& p : scene.meshes[0].positions) EXPECT_TRUE(is_finite(p));
  EXPECT_EQ(scene.meshes[0].bounds.lower, Vec3(0, 0, 0));
  EXPECT_EQ(scene.meshes[0].bounds.upper, Vec3(2, 2, 1));
}

TEST(GltfMesh, PrimitivesShareTheArraysOfOneAccessor) {
  GltfFile file;
  const int positions = add_zigzag(file);
  const int first = file.add_array<std::uint8_t>({0, 1, 2}, kUnsignedByte, 3, "SCALAR");
  const int second = file.add_array<std::uint8_t>({2, 1, 3}, kUnsignedByte, 3, "SCALAR");
  file.push("meshes", {{"primitives",
                        {{{"attributes", {{"POSITION", positions}}}, {"indices", first}},
                         {{"attributes", {{"POSITION", positions}}}, {"indices", second}}}}});
  file.add_root({{"mesh", 0}});
  const Scene scene = file.load();
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.meshes[0].positions, scene.meshes[1].positions);
  EXPECT_EQ(scene.meshes[1].bounds.lower, Vec3(0, 0, 0));
  EXPECT_EQ(scene.meshes[1].bounds.upper, Vec3(1, 1, 0));
}

TEST(GltfMesh, ASmallPartOfASharedArrayIsCopied) {
  GltfFile file;
  std::vector<float> many(3 * 1000);
  for (std::size_t i = 0; i < many.size(); ++i) many[i] = static_cast<float>((i * i * 31) % 1009);
  const int positions = file.add_accessor(file.add_view_bytes(std::as_bytes(std::span(many))), kFloat, 1000, "VEC3");
  const int indices = file.add_array<std::uint16_t>({900, 10, 500}, kUnsignedShort, 3, "SCALAR");
  const Scene scene = load_primitive(file, {{"attributes", {{"POSITION", positions}, {"NORMAL", positions}}}, {"indices", indices}});
  ASSERT_EQ(scene.meshes.size(), 1u);
  const Mesh& mesh = scene.meshes[0];
  ASSERT_EQ(mesh.positions.size(), 3u);
  ASSERT_EQ(mesh.normals.size(), 3u);
  const std::size_t used[3] = {900, 10, 500};
  for (int corner = 0; corner < 3; ++corner) {
    const std::size_t v = 3 * used[corner];
    EXPECT_EQ(mesh.positions[mesh.triangles[0][corner]], Vec3(many[v], many[v + 1], many[v + 2]));
  }
}

TEST(GltfMesh, NormalsAreMadeUnitAndBrokenOnesReplaced) {
  GltfFile file;
  const int normals = file.add_array<float>({0, 3, 0, 0, 0, 0, 0, 0, -0.1f}, kFloat, 3, "VEC3");
  const Scene scene = load_primitive(file, {{"attributes", {{"POSITION", file.add_triangle_positions()}, {"NORMAL", normals}}}});
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes[0].normals[0], Vec3(0, 1, 0));
  EXPECT_EQ(scene.meshes[0].normals[1], Vec3(0, 0, 1)) << "the face's";
  EXPECT_EQ(scene.meshes[0].normals[2], Vec3(0, 0, -1));
}

TEST(GltfMesh, WithoutNormalsThereAreNoTangentsEither) {
  GltfFile file;
  const int tangents = file.add_array<float>({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, kFloat, 3, "VEC4");
  const Scene scene = load_primitive(file, {{"attributes", {{"POSITION", file.add_triangle_positions()}, {"TANGENT", tangents}}}});
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_TRUE(scene.meshes[0].normals.empty());
  EXPECT_TRUE(scene.meshes[0].tangents.empty());
}

TEST(GltfMesh, TextureCoordinatesComeFromTheSetThatTheMaterialUses) {
  GltfFile file;
  file.push("images", {{"uri", "data:image/png;base64,AAAA"}});
  file.push("textures", {{"source", 0}});
  file.push("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}, {"texCoord", 1}}}}}});
  const int uv0 = file.add_array<std::uint8_t>({0, 0, 0, 0, 255, 0, 0, 0, 0, 255, 0, 0}, kUnsignedByte, 3, "VEC2", true);
  file.json["bufferViews"][file.json["accessors"][uv0]["bufferView"].get<int>()]["byteStride"] = 4;
  const int uv1 = file.add_array<float>({0.25f, 0, 1, 2, 3, 4}, kFloat, 3, "VEC2");
  const int positions = file.add_triangle_positions();
  const Scene scene =
      load_primitive(file, {{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uv0}, {"TEXCOORD_1", uv1}}}, {"material", 0}});
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes[0].uvs[0], Vec2(0.25f, 0));
  EXPECT_EQ(scene.meshes[0].uvs[2], Vec2(3, 4));

  file.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 0;
  EXPECT_EQ(file.load().meshes[0].uvs[1], Vec2(1, 0));
}

TEST(GltfMesh, AttributesOfAnotherLengthAreAnError) {
  GltfFile file;
  const int normals = file.add_array<float>({0, 0, 1, 0, 0, 1}, kFloat, 2, "VEC3");
  file.add_root({{"mesh", file.add_mesh({{"attributes", {{"POSITION", file.add_triangle_positions()}, {"NORMAL", normals}}}})}});
  EXPECT_NE(error_of(file).find("/meshes/0/primitives/0/attributes/NORMAL"), std::string::npos) << error_of(file);
}

}  // namespace
}  // namespace sightline::test
