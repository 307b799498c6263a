#include <gtest/gtest.h>

#include <functional>
#include <set>

#include "scene/scene.h"

namespace sightline {
namespace {

Scene make_scene() {
  Scene scene;
  scene.images.push_back({"a.png", std::make_shared<const Image>(Image{.width = 1, .height = 1, .channels = 1, .data = Image::Bytes{7}})});
  scene.textures.push_back({"t", ImageTexture{.image = ImageId(0)}});
  scene.materials.push_back({.name = "m"});
  scene.materials.push_back({.name = "n", .model = MetallicRoughnessMaterial{}});
  Mesh mesh;
  mesh.positions = std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = std::vector<UVec3>{{0, 1, 2}};
  scene.meshes.push_back(mesh);
  scene.instances.push_back({.name = "i", .mesh = MeshId(0)});
  scene.lights.push_back({.name = "l", .shape = PointLight{}});
  scene.cameras.push_back({.name = "c"});
  scene.nodes.push_back({.name = "n"});
  return scene;
}

TEST(SceneHash, IsEqualForEqualScenesHoweverTheirMemory) {
  Scene a = make_scene(), b = make_scene();
  EXPECT_EQ(scene_hash(a), scene_hash(b));
  b.name = "renamed";
  b.materials[0].name = b.meshes[0].name = b.cameras[0].name = b.lights[0].name = b.images[0].name = "renamed";
  b.warnings.push_back("a warning");
  EXPECT_EQ(scene_hash(a), scene_hash(b)) << "names and warnings change no picture";
}

TEST(SceneHash, ChangesWithEverythingThatChangesAPicture) {
  const std::vector<std::function<void(Scene&)>> edits = {
      [](Scene& s) {
        s.images[0].image = std::make_shared<const Image>(Image{.width = 1, .height = 1, .channels = 1, .data = Image::Bytes{8}});
      },
      [](Scene& s) { std::get<ImageTexture>(s.textures[0].node).wrap_v = Wrap::clamp; },
      [](Scene& s) { std::get<ImageTexture>(s.textures[0].node).uv.offset.y = 0.5f; },
      [](Scene& s) { std::get<ImageTexture>(s.textures[0].node).encoding = ColorEncoding::linear; },
      [](Scene& s) { s.textures[0].node = ConstantTexture{}; },
      [](Scene& s) { s.materials[0].model = MetallicRoughnessMaterial{}; },
      [](Scene& s) { s.materials[0].two_sided = false; },
      [](Scene& s) { s.materials[0].emission_two_sided = true; },
      [](Scene& s) { s.materials[0].alpha_cutoff = 0.25f; },
      [](Scene& s) { s.materials[0].alpha_mode = AlphaMode::mask; },
      [](Scene& s) { s.materials[0].normal_map = TextureId(0); },
      [](Scene& s) { s.materials[0].normal_scale = 2; },
      [](Scene& s) { s.materials[0].bump = TextureId(0); },
      [](Scene& s) { s.materials[0].bump_scale = 3; },
      [](Scene& s) { s.materials[0].interior = MediumId(0); },
      [](Scene& s) { s.materials[0].model = DielectricMaterial{}; },
      [](Scene& s) { s.materials[0].model = DielectricMaterial{.thin = true}; },
      [](Scene& s) { s.materials[0].model = DielectricMaterial{.eta = 1.3f}; },
      [](Scene& s) { s.materials[0].model = ConductorMaterial{}; },
      [](Scene& s) { s.materials[0].model = ConductorMaterial{.remap_roughness = true}; },
      [](Scene& s) { s.materials[0].model = PhongMaterial{.exponent = 5.f}; },
      [](Scene& s) { s.materials[0].model = WardMaterial{}; },
      [](Scene& s) { s.materials[0].model = WardMaterial{.alpha_y = 0.4f}; },
      [](Scene& s) { s.materials[0].model = CookTorranceMaterial{}; },
      [](Scene& s) { s.materials[0].model = CookTorranceMaterial{.f0 = 0.5f}; },
      [](Scene& s) { s.materials[0].model = MeasuredMaterial{.content_hash = 1}; },
      [](Scene& s) { s.materials[0].model = MeasuredMaterial{.content_hash = 2}; },
      [](Scene& s) { s.materials[0].alpha.channel = 3; },
      [](Scene& s) { s.materials[0].emission.value = Color(1); },
      [](Scene& s) { std::get<MetallicRoughnessMaterial>(s.materials[1].model).roughness.value = 0.5f; },
      [](Scene& s) { std::swap(s.materials[0], s.materials[1]); },
      [](Scene& s) { s.meshes[0].positions = std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}}; },
      [](Scene& s) { s.meshes[0].triangles = std::vector<UVec3>{{0, 2, 1}}; },
      [](Scene& s) { s.meshes[0].normals = std::vector<Vec3>(3, Vec3(0, 0, 1)); },
      [](Scene& s) { s.meshes[0].materials = {MaterialId(0)}; },
      [](Scene& s) { s.instances[0].world_from_object[3].x = 1; },
      [](Scene& s) { s.instances[0].node = NodeId(0); },
      [](Scene& s) { s.instances.push_back(s.instances[0]); },
      [](Scene& s) { s.spheres.push_back({}); },
      [](Scene& s) { std::get<PointLight>(s.lights[0].shape).intensity.y = 2; },
      [](Scene& s) { s.lights[0].shape = DirectionalLight{}; },
      [](Scene& s) { s.environment = Environment{}; },
      [](Scene& s) { s.environment = Environment{.mapping = EnvironmentMapping::angular}; },
      [](Scene& s) { s.environment = Environment{.scale = Color(2)}; },
      [](Scene& s) { s.cameras[0].fov_rad = 1; },
      [](Scene& s) { s.cameras[0].lens_radius = 1; },
      [](Scene& s) { s.cameras[0].focal_distance = 1; },
      [](Scene& s) { s.cameras[0].projection = Camera::Projection::orthographic; },
      [](Scene& s) { s.cameras[0].screen_window = Vec4(-1, -1, 1, 1); },
      [](Scene& s) { s.nodes[0].rotation_track.times_s = {0}; },
      [](Scene& s) { s.nodes[0].weights = {0.5f}; },
      [](Scene& s) { s.nodes[0].weights_track.times_s = {0}; },
      [](Scene& s) { s.skins.push_back({.name = "s", .joints = {NodeId(0)}}); },
      [](Scene& s) { s.meshes[0].deformation = std::make_shared<Deformation>(); },
      [](Scene& s) {
        Deformation deformation;
        deformation.targets.resize(1);
        s.meshes[0].deformation = std::make_shared<Deformation>(deformation);
      },
      [](Scene& s) { s.environment = Environment{.mapping = EnvironmentMapping::cube}; },
      [](Scene& s) { s.media.push_back({}); },
      [](Scene& s) { s.hints.max_bounces = 3; }};
  std::set<std::uint64_t> hashes = {scene_hash(make_scene())};
  for (std::size_t i = 0; i < edits.size(); ++i) {
    Scene edited = make_scene();
    edits[i](edited);
    EXPECT_TRUE(hashes.insert(scene_hash(edited)).second) << "edit " << i;
  }
}

}  // namespace
}  // namespace sightline
