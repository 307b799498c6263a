// Normals for meshes that have none.
#include <gtest/gtest.h>

#include "scene/builtin/builtin.h"
#include "scene/builtin/parts.h"
#include "scene/builtin/smooth_normals.h"

namespace sightline {
namespace {

using builtin::add_smooth_normals;
using builtin::MeshBuilder;

/// Every triangle with corners of its own.
Mesh as_soup(const Mesh& mesh) {
  std::vector<Vec3> positions;
  std::vector<UVec3> triangles;
  for (const UVec3& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    for (int corner = 0; corner < 3; ++corner) positions.push_back(mesh.positions[t[corner]]);
    triangles.push_back({first, first + 1, first + 2});
  }
  Mesh soup;
  soup.positions = SharedArray<Vec3>(positions);
  soup.triangles = SharedArray<UVec3>(triangles);
  return soup;
}

/// Largest angle between a normal and the direction from the origin.
float largest_radial_error_rad(const Mesh& mesh) {
  float least_cosine = 1;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    EXPECT_NEAR(glm::length(mesh.normals[i]), 1, 1e-5f);
    least_cosine = std::min(least_cosine, glm::dot(mesh.normals[i], glm::normalize(mesh.positions[i])));
  }
  return std::acos(least_cosine);
}

TEST(SmoothNormals, OfABallAreRadialAlsoWhereTrianglesShareNoCorners) {
  Mesh ball = MeshBuilder().ball(Vec3(0), 2, 24).build("ball");
  Mesh soup = as_soup(ball);
  add_smooth_normals(ball);
  add_smooth_normals(soup);
  EXPECT_LT(largest_radial_error_rad(ball), 0.01f);
  EXPECT_LT(largest_radial_error_rad(soup), 0.01f);
}

TEST(SmoothNormals, DoNotDependOnHowAFaceIsCut) {
  // A corner of a cube: whichever diagonal each square has, the mean is (1, 1, 1).
  Mesh corner;
  corner.positions = std::vector<Vec3>{{0, 0, 0}, {-1, 0, 0}, {-1, -1, 0}, {0, -1, 0}, {0, -1, -1}, {0, 0, -1}, {-1, 0, -1}};
  corner.triangles = std::vector<UVec3>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {5, 6, 1}, {5, 1, 0}};
  add_smooth_normals(corner);
  EXPECT_LT(glm::length(corner.normals[0] - glm::normalize(Vec3(1, 1, 1))), 1e-5f);
}

TEST(SmoothNormals, KeepEdgesThatTheListKeepsApart) {
  // A box of six quads: their normals differ by 90 degrees, more than the crease angle.
  Mesh box = MeshBuilder().box(Vec3(0), Vec3(1)).build("box");
  add_smooth_normals(box);
  for (std::size_t i = 0; i < box.positions.size(); ++i) {
    int along_axes = 0;
    for (int axis = 0; axis < 3; ++axis) along_axes += std::fabs(std::fabs(box.normals[i][axis]) - 1) < 1e-6f;
    EXPECT_EQ(along_axes, 1);
    EXPECT_GT(glm::dot(box.normals[i], box.positions[i]), 0);
  }
}

TEST(SmoothNormals, LeaveMeshesAloneThatHaveSomeAndBadOnesUnit) {
  Scene scene;
  Mesh mesh;
  mesh.positions = std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 5}};
  mesh.triangles = std::vector<UVec3>{{0, 1, 2}};
  scene.meshes = {mesh, mesh};
  scene.meshes[0].normals = std::vector<Vec3>(4, Vec3(1, 0, 0));
  add_smooth_normals(scene, Context{});
  EXPECT_EQ(scene.meshes[0].normals[0], Vec3(1, 0, 0));
  EXPECT_EQ(scene.meshes[1].normals[0], Vec3(0, 0, 1));
  EXPECT_NEAR(glm::length(scene.meshes[1].normals[3]), 1, 1e-6f) << "a vertex of no triangle";
}

TEST(SmoothNormals, OfStagesAreSmoothAfterSubdivisionToo) {
  const Context context;
  for (const char* stage : {"room", "open-room", "ground"}) {
    const std::string spec = std::string(stage) + ",content=furnace?shape=mesh";
    const Scene plain = build_builtin(spec + ",normals=file", {}, context);
    const Scene smooth = build_builtin(spec + ",normals=smooth", {}, context);
    EXPECT_TRUE(plain.meshes.at(0).normals.empty()) << stage;
    EXPECT_EQ(smooth.meshes.at(0).normals.size(), smooth.meshes[0].positions.size()) << stage;
  }
  const Scene fine = build_builtin("ground,content=furnace?shape=mesh,normals=smooth,min_vertices=100000", {}, context);
  ASSERT_GE(fine.meshes.at(0).positions.size(), 100000u);
  // The coarse ball stays a polyhedron, but shades as a ball: normals within its facets are those of the ball, nearly.
  EXPECT_LT(largest_radial_error_rad(fine.meshes[0]), 0.01f);
}

}  // namespace
}  // namespace sightline
