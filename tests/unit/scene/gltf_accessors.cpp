// Accessors of every component type, strided, sparse: seen through the positions and indices of a mesh.
#include <gtest/gtest.h>

#include "gltf_file.h"

namespace sightline::test {
namespace {

/// Loads a mesh whose positions are accessor `positions`, and gives them back.
std::vector<Vec3> load_positions(GltfFile& file, int positions) {
  file.add_root({{"mesh", file.add_mesh({{"attributes", {{"POSITION", positions}}}})}});
  const Scene scene = file.load();
  EXPECT_EQ(scene.meshes.size(), 1u);
  if (scene.meshes.empty()) return {};
  const auto span = scene.meshes[0].positions.span();
  return {span.begin(), span.end()};
}

template <class T>
std::vector<Vec3> load_typed(int component_type, bool normalized, T large) {
  GltfFile file;
  const int positions = file.add_array<T>({T(0), T(0), T(0), large, T(0), T(0), T(0), T(3), large}, component_type, 3, "VEC3", normalized);
  return load_positions(file, positions);
}

TEST(GltfAccessor, ReadsFloats) {
  const auto p = load_typed<float>(kFloat, false, 2.5f);
  EXPECT_EQ(p.at(1), Vec3(2.5f, 0, 0));
  EXPECT_EQ(p.at(2), Vec3(0, 3, 2.5f));
}

TEST(GltfAccessor, ReadsIntegersAsTheirValues) {
  // Three bytes a vertex are no multiple of four; packed data must still be read as it stands.
  EXPECT_EQ((load_typed<std::int8_t>(kByte, false, -100).at(2)), Vec3(0, 3, -100));
  EXPECT_EQ((load_typed<std::uint8_t>(kUnsignedByte, false, 200).at(2)), Vec3(0, 3, 200));
  EXPECT_EQ((load_typed<std::int16_t>(kShort, false, -30000).at(2)), Vec3(0, 3, -30000));
  EXPECT_EQ((load_typed<std::uint16_t>(kUnsignedShort, false, 60000).at(2)), Vec3(0, 3, 60000));
  EXPECT_EQ((load_typed<std::uint32_t>(kUnsignedInt, false, 1u << 24).at(2)), Vec3(0, 3, 16777216));
}

TEST(GltfAccessor, NormalisesIntegersToTheUnitRange) {
  EXPECT_EQ((load_typed<std::int8_t>(kByte, true, -128).at(2)), Vec3(0, 3.f / 127, -1));
  EXPECT_EQ((load_typed<std::uint8_t>(kUnsignedByte, true, 255).at(2)), Vec3(0, 3.f / 255, 1));
  EXPECT_EQ((load_typed<std::int16_t>(kShort, true, -32768).at(2)), Vec3(0, 3.f / 32767, -1));
  EXPECT_EQ((load_typed<std::uint16_t>(kUnsignedShort, true, 65535).at(2)), Vec3(0, 3.f / 65535, 1));
}

TEST(GltfAccessor, ReadsInterleavedAttributes) {
  GltfFile file;
  const int view = file.add_view<float>({0, 0, 0, /**/ 0, 0, 1, /**/ 1, 0, 0, /**/ 0, 1, 0, /**/ 0, 2, 0, /**/ 1, 0, 0}, 24);
  const int positions = file.add_accessor(view, kFloat, 3, "VEC3"), normals = file.add_accessor(view, kFloat, 3, "VEC3", false, 12);
  file.add_root({{"mesh", file.add_mesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}})}});
  const Scene scene = file.load();
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes[0].positions[2], Vec3(0, 2, 0));
  EXPECT_EQ(scene.meshes[0].normals[1], Vec3(0, 1, 0));
  EXPECT_EQ(scene.meshes[0].normals[2], Vec3(1, 0, 0));
}

TEST(GltfAccessor, LastStridedElementNeedsNoPadding) {
  // Two elements of 12 bytes at stride 16 occupy 28 bytes, not 32.
  GltfFile file;
  const int view = file.add_view<float>({0, 0, 0, 9, 1, 0, 0, 9, 0, 1, 0}, 16);
  EXPECT_EQ(load_positions(file, file.add_accessor(view, kFloat, 3, "VEC3")).at(2), Vec3(0, 1, 0));
}

nlohmann::json sparse_over(GltfFile& file, int index_type, int index_view) {
  return {{"count", 2},
          {"indices", {{"bufferView", index_view}, {"componentType", index_type}}},
          {"values", {{"bufferView", file.add_view<float>({5, 6, 7, 8, 9, 10})}}}};
}

TEST(GltfAccessor, SparseValuesReplaceThoseOfTheView) {
  GltfFile file;
  const int positions = file.add_triangle_positions();
  file.json["accessors"][positions]["sparse"] = sparse_over(file, kUnsignedShort, file.add_view<std::uint16_t>({0, 2}));
  const auto p = load_positions(file, positions);
  EXPECT_EQ(p.at(0), Vec3(5, 6, 7));
  EXPECT_EQ(p.at(1), Vec3(1, 0, 0));
  EXPECT_EQ(p.at(2), Vec3(8, 9, 10));
}

TEST(GltfAccessor, SparseWithoutViewStartsFromZeros) {
  GltfFile file;
  const int positions = file.add_accessor(-1, kFloat, 3, "VEC3");
  file.json["accessors"][positions]["sparse"] = sparse_over(file, kUnsignedByte, file.add_view<std::uint8_t>({1, 2}));
  const auto p = load_positions(file, positions);
  EXPECT_EQ(p.at(0), Vec3(0));
  EXPECT_EQ(p.at(2), Vec3(8, 9, 10));
}

TEST(GltfAccessor, IndicesOfEveryUnsignedType) {
  const auto load = [](GltfFile file, int indices) {
    file.add_root({{"mesh", file.add_mesh({{"attributes", {{"POSITION", file.add_triangle_positions()}}}, {"indices", indices}})}});
    const Scene scene = file.load();
    return scene.meshes.empty() ? UVec3(0) : scene.meshes[0].triangles[0];
  };
  GltfFile bytes, words, integers;
  const int b = bytes.add_array<std::uint8_t>({2, 0, 1}, kUnsignedByte, 3, "SCALAR");
  const int w = words.add_array<std::uint16_t>({2, 0, 1}, kUnsignedShort, 3, "SCALAR");
  const int i = integers.add_array<std::uint32_t>({2, 0, 1}, kUnsignedInt, 3, "SCALAR");
  EXPECT_EQ(load(bytes, b), UVec3(2, 0, 1));
  EXPECT_EQ(load(words, w), UVec3(2, 0, 1));
  EXPECT_EQ(load(integers, i), UVec3(2, 0, 1));
}

TEST(GltfAccessor, BufferInGlbEqualsBufferInUri) {
  GltfFile file;
  file.add_root({{"mesh", file.add_mesh({{"attributes", {{"POSITION", file.add_triangle_positions()}}}})}});
  Context context;
  const std::vector<std::byte> glb = file.glb();
  EXPECT_EQ(scene_hash(parse_gltf(glb, "test.glb", context)), scene_hash(file.load()));
}

}  // namespace
}  // namespace sightline::test
