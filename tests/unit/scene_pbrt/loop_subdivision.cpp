#include "scene/load/pbrt/loop_subdivision.h"

#include "unit/scene_pbrt/pbrt_text.h"

namespace sightline::pbrt {
namespace {

const std::vector<Vec3> kOctahedron = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
const std::vector<std::int32_t> kOctahedronFaces = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};

TEST(PbrtLoopSubdivision, FourTrianglesALevelOnASmoothClosedSurface) {
  for (int levels = 0; levels < 5; ++levels) {
    const MeshArrays mesh = subdivide_loop(kOctahedron, kOctahedronFaces, levels, Place{});
    EXPECT_EQ(mesh.triangles.size(), std::size_t{8} << (2 * levels));
    EXPECT_EQ(mesh.positions.size(), mesh.triangles.size() / 2 + 2);  // Euler's formula
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      EXPECT_GT(glm::dot(glm::normalize(mesh.positions[i]), glm::normalize(mesh.normals[i])), 0.95f);
    }
  }
}

TEST(PbrtLoopSubdivision, VerticesLieOnTheLimitSurfaceAtEveryLevel) {
  // The limit of an octahedron's corner (valence 4): weight w = 1 / (4 + 3 / (8 b)), b = 3/32, of each of the four neighbours, which
  // cancel: 1 - 4 w = 1/2.
  for (int levels = 0; levels < 4; ++levels) {
    EXPECT_NEAR(subdivide_loop(kOctahedron, kOctahedronFaces, levels, Place{}).positions[0].x, 0.5f, 1e-5f) << levels;
  }
}

TEST(PbrtLoopSubdivision, AFlatSheetStaysFlatAndItsStraightBordersStraight) {
  const std::vector<Vec3> square = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}};
  const std::vector<std::int32_t> faces = {0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4};
  const MeshArrays mesh = subdivide_loop(square, faces, 3, Place{});
  for (const Vec3& p : mesh.positions) {
    EXPECT_EQ(p.z, 0);
    EXPECT_GE(p.y, -1e-6f);
    EXPECT_LE(p.y, 1 + 1e-6f);
  }
  for (const Vec3& n : mesh.normals) EXPECT_GT(n.z, 0);
}

TEST(PbrtLoopSubdivision, BadTopologyIsAnError) {
  EXPECT_THROW(subdivide_loop(kOctahedron, std::vector<std::int32_t>{0, 1, 9}, 1, Place{}), Error);
  EXPECT_THROW(subdivide_loop(kOctahedron, std::vector<std::int32_t>{0, 1, 2, 1, 0, 3, 0, 1, 4}, 1, Place{}), Error);
  const Scene scene =
      parse_world("Shape \"loopsubdiv\" \"integer levels\" 30 \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2]\n");
  EXPECT_TRUE(warns_of(scene, "30 levels of subdivision are too many"));
  EXPECT_LE(scene.meshes.at(0).triangles.size(), std::size_t{1} << 23);
}

}  // namespace
}  // namespace sightline::pbrt
