#include "unit/scene_pbrt/pbrt_text.h"

namespace sightline {
namespace {

double area_of(const Mesh& mesh) {
  double area = 0;
  for (const UVec3& t : mesh.triangles) {
    area += 0.5 * static_cast<double>(
                      glm::length(glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x])));
  }
  return area;
}

TEST(PbrtShapes, TriangleMeshKeepsItsArraysAndFlipsV) {
  const Scene scene = parse_world(kTriangle);
  ASSERT_EQ(scene.meshes.size(), 1u);
  ASSERT_EQ(scene.instances.size(), 1u);
  const Mesh& mesh = scene.meshes[0];
  EXPECT_EQ(mesh.triangles[0], UVec3(0, 1, 2));
  EXPECT_EQ(mesh.uvs[0], Vec2(0, 1));
  EXPECT_EQ(mesh.uvs[1], Vec2(1, 1));
  EXPECT_EQ(mesh.uvs[2], Vec2(0, 0));
  EXPECT_EQ(mesh.bounds.lower, Vec3(0));
  EXPECT_EQ(mesh.bounds.upper, Vec3(1, 1, 0));
  EXPECT_EQ(scene.instances[0].world_from_object, Mat4(1));
}

TEST(PbrtShapes, BadTrianglesAreDroppedAndCounted) {
  const Scene scene = parse_world(
      "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 nan 0 0 2 0 0] \"integer indices\" [0 1 2  0 1 3  0 1 1  0 1 4]\n");
  EXPECT_EQ(scene.meshes[0].triangles.size(), 1u);
  EXPECT_EQ(scene.dropped_triangles, 3u);
}

TEST(PbrtShapes, BadIndicesAreErrorsWithPlace) {
  for (const char* indices : {"[0 1 3]", "[0 1 -1]", "[0 1 2000000000]"}) {
    const std::string message =
        error_of("WorldBegin\n Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" " + std::string(indices));
    EXPECT_NE(message.find("test.pbrt:2:2: index"), std::string::npos) << message;
  }
  EXPECT_NE(error_of("WorldBegin Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" []")
                .find("needs \"integer indices\""),
            std::string::npos);
  EXPECT_NE(error_of("WorldBegin Shape \"trianglemesh\" \"point3 P\" [0 0 0 1]").find("not a multiple of 3"), std::string::npos);
}

TEST(PbrtShapes, AWholeSphereUnderUniformScaleStaysAnalytic) {
  const Scene scene =
      parse_world("Translate 1 2 3 Scale -2 2 2 Rotate 30 1 1 0 ReverseOrientation Shape \"sphere\" \"float radius\" 1.5\n");
  ASSERT_EQ(scene.spheres.size(), 1u);
  EXPECT_TRUE(scene.meshes.empty());
  expect_near(scene.spheres[0].center, {1, 2, 3});
  EXPECT_NEAR(scene.spheres[0].radius, 3, 1e-5);
  EXPECT_TRUE(scene.spheres[0].reverse_orientation);
}

TEST(PbrtShapes, OtherSpheresAreTessellatedWithOutwardNormals) {
  for (const char* shape : {"Scale 1 2 3 Shape \"sphere\"", "Shape \"sphere\" \"float zmax\" .5", "Shape \"sphere\" \"float phimax\" 90"}) {
    const Scene scene = parse_world(shape);
    EXPECT_TRUE(scene.spheres.empty());
    ASSERT_EQ(scene.meshes.size(), 1u) << shape;
    EXPECT_EQ(scene.dropped_triangles, 0u);
    const Mesh& mesh = scene.meshes[0];
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const Vec3 center =
          (mesh.positions[mesh.triangles[i].x] + mesh.positions[mesh.triangles[i].y] + mesh.positions[mesh.triangles[i].z]) / 3.f;
      ASSERT_GT(glm::dot(face_normal(mesh, i), center), 0) << shape << " triangle " << i;
    }
  }
  // A cap of height h of the unit sphere has area 2 pi h, an eighth of a turn of it an eighth.
  const Scene cap = parse_world("Shape \"sphere\" \"float zmin\" .5 \"float phimax\" 45");
  EXPECT_NEAR(area_of(cap.meshes[0]), 2 * 3.14159265 * 0.5 / 8, 2e-3);
}

TEST(PbrtShapes, ADiskKeepsItsAreaAndFacesZ) {
  const Scene scene = parse_world(
      "Shape \"disk\" \"float radius\" 2 \"float height\" 3 \"float innerradius\" 1\nShape \"disk\" \"float radius\" 2\nReverseOrientation "
      "Shape \"disk\"\n");
  EXPECT_NEAR(area_of(scene.meshes[0]), 3.14159265 * 3, 1e-4);
  EXPECT_NEAR(area_of(scene.meshes[1]), 3.14159265 * 4, 1e-4);
  EXPECT_GT(face_normal(scene.meshes[0]).z, 0.99f);
  EXPECT_LT(face_normal(scene.meshes[2]).z, -0.99f);
  EXPECT_FLOAT_EQ(scene.meshes[0].positions[0].z, 3);
  EXPECT_EQ(scene.dropped_triangles, 0u);
}

TEST(PbrtShapes, ABilinearPatchGoesThroughItsCornersAndCentre) {
  const Scene flat = parse_world("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 2 0 0 0 1 0 2 1 0]\n");
  EXPECT_EQ(flat.meshes[0].triangles.size(), 2u);
  EXPECT_NEAR(area_of(flat.meshes[0]), 2, 1e-6);
  EXPECT_GT(face_normal(flat.meshes[0]).z, 0.99f);
  const Scene bent = parse_world("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 1] \"integer indices\" [0 1 2 3]\n");
  const Mesh& mesh = bent.meshes[0];
  EXPECT_GT(mesh.triangles.size(), 100u);
  for (const Vec3& p : mesh.positions) EXPECT_NEAR(p.z, p.x * p.y, 1e-6f);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) EXPECT_GT(face_normal(mesh, i).z, 0);
}

TEST(PbrtShapes, ACylinderFacesOutward) {
  const Scene scene = parse_world("Shape \"cylinder\" \"float radius\" 2 \"float zmin\" 0 \"float zmax\" 3\n");
  EXPECT_NEAR(area_of(scene.meshes[0]), 2 * 3.14159265 * 2 * 3, 0.05);
  const Mesh& mesh = scene.meshes[0];
  EXPECT_GT(glm::dot(face_normal(mesh), mesh.positions[mesh.triangles[0].x] * Vec3(1, 1, 0)), 0);
}

TEST(PbrtShapes, UnknownOnesAreReportedAndLeftOut) {
  const Scene scene = parse_world("  Shape \"curve\" \"float width\" 1\n" + std::string(kTriangle));
  EXPECT_EQ(scene.meshes.size(), 1u);
  EXPECT_TRUE(warns_of(scene, "test.pbrt:2:3: shape 'curve' is not supported"));
}

TEST(PbrtShapes, AlphaBecomesCoverage) {
  const Scene scene = parse_world(
      "Texture \"holes\" \"float\" \"checkerboard\"\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"texture alpha\" \"holes\"\n"
      "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"float alpha\" .25\n" +
      std::string(kTriangle));
  ASSERT_EQ(scene.materials.size(), 3u);
  EXPECT_EQ(scene.materials[0].alpha_mode, AlphaMode::blend);
  EXPECT_TRUE(scene.materials[0].alpha.texture.valid());
  EXPECT_FLOAT_EQ(scene.materials[1].alpha.value, 0.25f);
  EXPECT_EQ(scene.materials[2].alpha_mode, AlphaMode::opaque);
}

}  // namespace
}  // namespace sightline
