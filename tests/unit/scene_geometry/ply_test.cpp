// PLY: every encoding of one mesh reads the same, and no damage does worse than an error.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "base/core/error.h"
#include "scene/load/load.h"

namespace sightline {
namespace {

Scene ply_scene(const std::string& text) {
  const Context context;
  return parse_ply(std::as_bytes(std::span(text.data(), text.size())), "test.ply", context);
}

std::string header(const std::string& encoding) {
  return "ply\nformat " + encoding +
         " 1.0\ncomment a pentagon\nelement vertex 5\nproperty float x\nproperty double y\nproperty float z\nproperty uchar extra\n"
         "property float u\nproperty float v\nelement face 2\nproperty short flag\nproperty list uchar int vertex_indices\nend_header\n";
}

constexpr float kPoints[5][2] = {{0, 0}, {2, 0}, {3, 1}, {1, 2}, {-1, 1}};

template <class T>
void put(std::string& out, T value, bool big) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  if (big) std::reverse(bytes, bytes + sizeof(T));
  out.append(bytes, sizeof(T));
}

std::string ascii() {
  std::string text = header("ascii");
  for (const auto& p : kPoints) text += std::to_string(p[0]) + " " + std::to_string(p[1]) + " 0.5 7 0.25 0.75\n";
  return text + "1 5 0 1 2 3 4\n-1 3 0 2 4\n";
}

std::string binary(bool big) {
  std::string out = header(big ? "binary_big_endian" : "binary_little_endian");
  for (const auto& p : kPoints) {
    put(out, p[0], big);
    put(out, static_cast<double>(p[1]), big);
    put(out, 0.5f, big);
    put(out, std::uint8_t{7}, big);
    put(out, 0.25f, big);
    put(out, 0.75f, big);
  }
  for (const std::vector<std::int32_t>& face : {std::vector<std::int32_t>{0, 1, 2, 3, 4}, {0, 2, 4}}) {
    put(out, std::int16_t{1}, big);
    put(out, static_cast<std::uint8_t>(face.size()), big);
    for (const std::int32_t i : face) put(out, i, big);
  }
  return out;
}

TEST(Ply, EncodingsOfOneMeshReadTheSame) {
  const Mesh expected = ply_scene(ascii()).meshes.at(0);
  ASSERT_EQ(expected.positions.size(), 5u);
  ASSERT_EQ(expected.triangles.size(), 4u);  // a fan of three, and one
  EXPECT_EQ(expected.triangles[1], UVec3(0, 2, 3));
  EXPECT_EQ(expected.positions[3], Vec3(1, 2, 0.5f));
  EXPECT_EQ(expected.uvs[0], Vec2(0.25f, 0.25f));  // v counts from the top
  for (const bool big : {false, true}) {
    const Mesh mesh = ply_scene(binary(big)).meshes.at(0);
    EXPECT_TRUE(std::equal(mesh.positions.begin(), mesh.positions.end(), expected.positions.begin(), expected.positions.end()));
    EXPECT_TRUE(std::equal(mesh.triangles.begin(), mesh.triangles.end(), expected.triangles.begin(), expected.triangles.end()));
    EXPECT_TRUE(std::equal(mesh.uvs.begin(), mesh.uvs.end(), expected.uvs.begin(), expected.uvs.end()));
  }
}

TEST(Ply, TruncationAnywhereIsAnErrorThatNamesTheFile) {
  for (const std::string& whole : {ascii(), binary(false), binary(true)}) {
    for (std::size_t size = 0; size + 2 < whole.size(); ++size) {
      try {
        ply_scene(whole.substr(0, size));
        ADD_FAILURE() << "accepted " << size << " of " << whole.size() << " bytes";
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input);
        EXPECT_NE(std::string(error.what()).find("test.ply"), std::string::npos);
      }
    }
  }
}

TEST(Ply, CountsBeyondTheFileAreRefused) {
  EXPECT_THROW(
      ply_scene("ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float "
                "z\nend_header\n"),
      Error);
}

TEST(Ply, NonFiniteVerticesLoseTheirTriangles) {
  const Scene scene = ply_scene(
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 3\nproperty list uchar "
      "int vertex_index\nend_header\n0 0 0\n1 0 0\n0 1 0\nnan 0 0\n3 0 1 2\n3 0 1 3\n3 1 1 2\n");
  EXPECT_EQ(scene.meshes[0].triangles.size(), 1u);
  EXPECT_EQ(scene.dropped_triangles, 2u);
  for (const Vec3& p : scene.meshes[0].positions) EXPECT_TRUE(is_finite(p));
}

}  // namespace
}  // namespace sightline
