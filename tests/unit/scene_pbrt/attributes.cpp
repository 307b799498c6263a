#include "unit/scene_pbrt/pbrt_text.h"

namespace sightline {
namespace {

const DiffuseMaterial& diffuse_of(const Scene& scene, std::size_t mesh) {
  return std::get<DiffuseMaterial>(scene.materials[scene.meshes[mesh].material_of(0).index].model);
}

TEST(PbrtAttributes, NestedBlocksRestoreEverything) {
  const std::string triangle = kTriangle;
  const Scene scene = parse_world(
      "Material \"diffuse\" \"rgb reflectance\" [.1 .1 .1]\n"
      "AttributeBegin\n Translate 1 0 0 Material \"diffuse\" \"rgb reflectance\" [.2 .2 .2] ReverseOrientation\n"
      "  AttributeBegin\n AreaLightSource \"diffuse\" \"rgb L\" [3 3 3] Translate 1 0 0\n" +
      triangle + "  AttributeEnd\n" + triangle + "AttributeEnd\n" + triangle);
  ASSERT_EQ(scene.meshes.size(), 3u);
  EXPECT_FLOAT_EQ(scene.meshes[0].positions[0].x, 2);
  EXPECT_FLOAT_EQ(scene.meshes[1].positions[0].x, 1);
  EXPECT_FLOAT_EQ(scene.meshes[2].positions[0].x, 0);
  EXPECT_FLOAT_EQ(diffuse_of(scene, 0).reflectance.value.x, 0.2f);
  EXPECT_FLOAT_EQ(diffuse_of(scene, 2).reflectance.value.x, 0.1f);
  EXPECT_FLOAT_EQ(scene.materials[scene.meshes[0].material_of(0).index].emission.value.x, 3);
  EXPECT_FLOAT_EQ(scene.materials[scene.meshes[1].material_of(0).index].emission.value.x, 0);
  EXPECT_LT(face_normal(scene.meshes[1]).z, 0);
  EXPECT_GT(face_normal(scene.meshes[2]).z, 0);
}

TEST(PbrtAttributes, WorldBeginForgetsTheCamerasTransformation) {
  const Scene scene = parse_text("Translate 5 5 5 WorldBegin\n" + std::string(kTriangle));
  expect_near(scene.meshes[0].positions[0], {0, 0, 0});
}

TEST(PbrtAttributes, DefaultsApplyUntilTheBlockEnds) {
  const Scene scene =
      parse_world("AttributeBegin Attribute \"material\" \"rgb reflectance\" [.3 .3 .3] Material \"diffuse\"\n" + std::string(kTriangle) +
                  "Material \"diffuse\" \"rgb reflectance\" [.4 .4 .4]\n" + kTriangle + "AttributeEnd Material \"diffuse\"\n" + kTriangle);
  EXPECT_FLOAT_EQ(diffuse_of(scene, 0).reflectance.value.x, 0.3f);
  EXPECT_FLOAT_EQ(diffuse_of(scene, 1).reflectance.value.x, 0.4f);
  EXPECT_FLOAT_EQ(diffuse_of(scene, 2).reflectance.value.x, 0.5f);
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(PbrtAttributes, MisnestedBlocksAreErrorsWithBothPlaces) {
  EXPECT_EQ(error_of("WorldBegin\nAttributeEnd"), "test.pbrt:2:1: AttributeEnd without AttributeBegin");
  EXPECT_EQ(error_of("WorldBegin\n  AttributeBegin\nTransformEnd"),
            "test.pbrt:3:1: TransformEnd closes the AttributeBegin of test.pbrt:2:3");
  EXPECT_EQ(error_of("WorldBegin\n  AttributeBegin"), "test.pbrt:2:3: this AttributeBegin is never closed");
  EXPECT_EQ(error_of("AttributeBegin AttributeEnd\n"), "test.pbrt:2:1: the file ends before WorldBegin");
  EXPECT_EQ(error_of("WorldBegin\nWorldBegin"), "test.pbrt:2:1: a second WorldBegin");
}

TEST(PbrtAttributes, OptionsAfterWorldBeginAreReported) {
  const Scene scene = parse_world("Film \"rgb\" \"integer xresolution\" 7\n");
  EXPECT_FALSE(scene.hints.size_px.has_value());
  EXPECT_TRUE(warns_of(scene, "test.pbrt:2:1: Film after WorldBegin has no effect"));
}

}  // namespace
}  // namespace sightline
