// OBJ: indices, polygons and damage.
#include <gtest/gtest.h>

#include <string>

#include "base/core/error.h"
#include "scene/load/load.h"

namespace sightline {
namespace {

Scene obj_scene(const std::string& text) { return parse_obj(text, "test.obj", Context{}); }

double area(const Mesh& mesh) {
  double sum = 0;
  for (const UVec3& t : mesh.triangles) {
    sum += 0.5 * glm::length(glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]));
  }
  return sum;
}

TEST(Obj, NegativeIndicesCountBack) {
  const Scene a = obj_scene("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), b = obj_scene("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n");
  EXPECT_EQ(a.meshes[0].triangles[0], b.meshes[0].triangles[0]);
}

TEST(Obj, ConcavePolygonKeepsItsArea) {
  // An L of area 3, listed from each corner in turn.
  const float corners[6][2] = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  for (int first = 0; first < 6; ++first) {
    std::string text;
    for (int i = 0; i < 6; ++i) {
      const auto& c = corners[(first + i) % 6];
      text += "v " + std::to_string(c[0]) + " 5 " + std::to_string(c[1]) + "\n";
    }
    EXPECT_NEAR(area(obj_scene(text + "f 1 2 3 4 5 6\n").meshes[0]), 3, 1e-5) << first;
  }
}

TEST(Obj, BadIndexNamesItsLine) {
  try {
    obj_scene("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("test.obj:4"), std::string::npos);
  }
}

TEST(Obj, TruncationNeverCrashes) {
  const std::string whole = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 1\nvn 0 0 1\nusemtl x\nf 1/1/1 2//1 \\\n3\n";
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    try {
      obj_scene(whole.substr(0, size));
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input);
    }
  }
}

}  // namespace
}  // namespace sightline
