#include "unit/scene_pbrt/pbrt_text.h"

namespace sightline {
namespace {

TEST(PbrtObjects, AnInstancePlacesTheObjectsSpaceByItsOwnTransformation) {
  const Scene scene = parse_world("Translate 1 0 0 ObjectBegin \"thing\" Translate 0 1 0\n" + std::string(kTriangle) +
                                  "ObjectEnd\nIdentity Scale 2 2 2 ObjectInstance \"thing\" Translate 0 0 5 ObjectInstance \"thing\"\n");
  ASSERT_EQ(scene.meshes.size(), 1u);
  ASSERT_EQ(scene.instances.size(), 2u);
  expect_near(scene.meshes[0].positions[0], {1, 1, 0});
  expect_near(transform_point(scene.instances[0].world_from_object, scene.meshes[0].positions[0]), {2, 2, 0});
  expect_near(transform_point(scene.instances[1].world_from_object, scene.meshes[0].positions[0]), {2, 2, 10});
}

TEST(PbrtObjects, ManyShapesOfAnObjectAreOneMeshWithAPalette) {
  const std::string triangle = kTriangle;
  const Scene scene = parse_world("ObjectBegin \"o\" Material \"diffuse\" \"rgb reflectance\" [.1 .1 .1]\n" + triangle +
                                  "Material \"conductor\"\n" + triangle + triangle + "ObjectEnd ObjectInstance \"o\"\n");
  ASSERT_EQ(scene.meshes.size(), 1u);
  const Mesh& mesh = scene.meshes[0];
  EXPECT_EQ(mesh.triangles.size(), 3u);
  ASSERT_EQ(mesh.materials.size(), 2u);
  EXPECT_TRUE(std::holds_alternative<DiffuseMaterial>(scene.materials[mesh.material_of(0).index].model));
  EXPECT_TRUE(std::holds_alternative<ConductorMaterial>(scene.materials[mesh.material_of(1).index].model));
  EXPECT_EQ(mesh.material_of(1), mesh.material_of(2));
}

TEST(PbrtObjects, NothingIsMadeOfAnObjectThatNobodyPlaces) {
  const Scene scene = parse_world("ObjectBegin \"o\"\n" + std::string(kTriangle) + "ObjectEnd\n");
  EXPECT_TRUE(scene.meshes.empty());
  EXPECT_TRUE(scene.instances.empty());
}

TEST(PbrtObjects, SpheresInObjectsFollowTheInstance) {
  const Scene scene = parse_world("ObjectBegin \"o\" Shape \"sphere\" ObjectEnd Translate 5 0 0 ObjectInstance \"o\"\n");
  EXPECT_TRUE(scene.spheres.empty());
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_NEAR(scene_bounds(scene).upper.x, 6, 1e-4f);
}

TEST(PbrtObjects, MistakesAreReported) {
  const Scene scene = parse_world("ObjectBegin \"lamp\" AreaLightSource \"diffuse\"\n" + std::string(kTriangle) +
                                  "ObjectEnd ObjectInstance \"lamp\"\nObjectInstance \"lamb\"\n");
  EXPECT_TRUE(warns_of(scene, "area lights inside object definitions do not emit"));
  EXPECT_TRUE(warns_of(scene, "test.pbrt:5:1: there is no object 'lamb' (did you mean 'lamp'?)")) << scene.warnings.back();
  EXPECT_EQ(scene.instances.size(), 1u);
  EXPECT_NE(error_of("WorldBegin ObjectBegin \"a\" ObjectBegin \"b\"").find("an object inside an object"), std::string::npos);
  EXPECT_NE(error_of("WorldBegin ObjectBegin \"a\" ObjectInstance \"a\"").find("an instance inside"), std::string::npos);
}

}  // namespace
}  // namespace sightline
