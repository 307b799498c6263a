#include <gtest/gtest.h>

#include "scene/load/load.h"

namespace sightline {
namespace {

/// A scene that has one of everything, all of whose ids are 0.
Scene make_scene(const std::string& name) {
  Scene scene;
  scene.name = name;
  scene.images.push_back({name, nullptr});
  scene.textures.push_back({name, ImageTexture{.image = ImageId(0)}});
  scene.textures.push_back({name, MixTexture{.first = TextureId(0), .second = TextureId(0), .amount = TextureId(0)}});
  scene.media.push_back({.name = name});
  MetallicRoughnessMaterial model;
  model.base_color.texture = model.metallic.texture = TextureId(1);
  scene.materials.push_back({.name = name, .model = model, .normal_map = TextureId(0), .interior = MediumId(0)});
  scene.materials.back().alpha.texture = TextureId(0);
  scene.materials.push_back({.name = name, .model = MixMaterial{.first = MaterialId(0), .second = MaterialId(0)}});
  scene.meshes.push_back({.name = name, .materials = {MaterialId(1)}});
  scene.instances.push_back({.name = name, .mesh = MeshId(0), .material_override = MaterialId(0), .node = NodeId(1)});
  scene.spheres.push_back({.name = name, .material = MaterialId(1)});
  scene.lights.push_back({.name = name, .shape = PointLight{}, .node = NodeId(1)});
  scene.cameras.push_back({.name = name, .node = NodeId(0)});
  scene.nodes.push_back({.name = name});
  scene.nodes.push_back({.name = name, .parent = NodeId(0)});
  scene.dropped_triangles = 2;
  return scene;
}

TEST(Merge, ShiftsEveryId) {
  Scene scene = make_scene("a");
  merge_into(scene, make_scene("b"));
  EXPECT_EQ(std::get<ImageTexture>(scene.textures[2].node).image, ImageId(1));
  EXPECT_EQ(std::get<MixTexture>(scene.textures[3].node).amount, TextureId(2));
  const auto& model = std::get<MetallicRoughnessMaterial>(scene.materials[2].model);
  EXPECT_EQ(model.base_color.texture, TextureId(3));
  EXPECT_EQ(model.metallic.texture, TextureId(3));
  EXPECT_FALSE(model.roughness.texture.valid()) << "what was unset stays unset";
  EXPECT_EQ(scene.materials[2].normal_map, TextureId(2));
  EXPECT_FALSE(scene.materials[2].bump.valid());
  EXPECT_EQ(scene.materials[2].alpha.texture, TextureId(2));
  EXPECT_EQ(scene.materials[2].interior, MediumId(1));
  EXPECT_EQ(std::get<MixMaterial>(scene.materials[3].model).second, MaterialId(2));
  EXPECT_EQ(scene.meshes[1].materials[0], MaterialId(3));
  EXPECT_EQ(scene.instances[1].mesh, MeshId(1));
  EXPECT_EQ(scene.instances[1].material_override, MaterialId(2));
  EXPECT_EQ(scene.instances[1].node, NodeId(3));
  EXPECT_EQ(scene.spheres[1].material, MaterialId(3));
  EXPECT_EQ(scene.lights[1].node, NodeId(3));
  EXPECT_EQ(scene.cameras[1].node, NodeId(2));
  EXPECT_FALSE(scene.nodes[2].parent.valid());
  EXPECT_EQ(scene.nodes[3].parent, NodeId(2));
  EXPECT_EQ(scene.dropped_triangles, 4u);
}

TEST(Merge, FirstCameraEnvironmentAndHintsWin) {
  Scene a = make_scene("a"), b = make_scene("b");
  b.environment = Environment{.name = "b"};
  b.hints.spp = 5;
  Scene c = make_scene("c");
  c.environment = Environment{.name = "c"};
  c.hints.spp = 9;
  merge_into(a, b);
  merge_into(a, c);
  EXPECT_EQ(a.cameras[0].name, "a");
  EXPECT_EQ(a.cameras.size(), 3u);
  EXPECT_EQ(a.environment->name, "b");
  EXPECT_EQ(a.hints.spp, 5);
}

TEST(Merge, FramingCoversTheGeometryOfBoth) {
  Scene ground, other;
  ground.framing = Bounds{Vec3(-1), Vec3(1)};
  other.spheres.push_back({.center = {10, 0, 0}, .radius = 1});
  merge_into(ground, other);
  EXPECT_EQ(ground.framing->lower, Vec3(-1));
  EXPECT_EQ(ground.framing->upper, Vec3(11, 1, 1));
}

}  // namespace
}  // namespace sightline
