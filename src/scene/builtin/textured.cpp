// A checkerboard floor and a shrub of alpha-masked leaves: textures, filtering, cut-outs.
#include <cmath>
#include <memory>

#include "scene/builtin/parts.h"
#include "scene/builtin/scenes.h"
#include "scene/builtin/seeded.h"

namespace sightline::builtin {
namespace {

struct TexturedSettings {
  int leaves = 300;
  std::uint64_t seed = 1;
  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("leaves", &TexturedSettings::leaves, {.help = "number of leaves", .minimum = 0, .maximum = 1e6});
    visit("seed", &TexturedSettings::seed, {.help = "of their places"});
  }
};

/// RGBA picture of a leaf: green with veins, alpha 1 inside its outline.
std::shared_ptr<const Image> leaf_image() {
  constexpr int kSize = 128;
  auto image = std::make_shared<Image>();
  image->width = image->height = kSize;
  image->channels = 4;
  Image::Bytes pixels;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const float u = 2 * (static_cast<float>(x) + 0.5f) / kSize - 1, v = (static_cast<float>(y) + 0.5f) / kSize;
      const float half_width = 0.75f * std::sin(kPi * v) * (0.55f + 0.45f * v);
      const bool inside = std::fabs(u) < half_width && v > 0.02f && v < 0.98f;
      const float side = std::fabs(u) * 0.6f + v;
      const bool vein = std::fabs(u) < 0.03f || std::fmod(side * 7, 1.f) < 0.12f;
      pixels.push_back(vein ? 150 : 70);
      pixels.push_back(vein ? 180 : 135);
      pixels.push_back(vein ? 80 : 45);
      pixels.push_back(inside ? 255 : 0);
    }
  }
  image->data = std::move(pixels);
  return image;
}

TextureId add_texture(Scene& scene, Texture texture) {
  scene.textures.push_back(std::move(texture));
  return TextureId(scene.textures.size() - 1);
}

Scene build_textured(const TexturedSettings& s, const LoadOptions&, const Context&) {
  Scene scene;
  const TextureId light = add_texture(scene, {.name = "light", .node = ConstantTexture{Vec4(0.75f, 0.72f, 0.65f, 1)}});
  const TextureId dark = add_texture(scene, {.name = "dark", .node = ConstantTexture{Vec4(0.12f, 0.15f, 0.22f, 1)}});
  CheckerboardTexture checks{.even = light, .odd = dark, .uv = {}};
  checks.uv.matrix = glm::mat2(32.f);
  DiffuseMaterial floor;
  floor.reflectance.texture = add_texture(scene, {.name = "checks", .node = checks});
  const MaterialId floor_id = add_material(scene, "floor", floor);
  add_mesh(scene, MeshBuilder().quad({-16, 0, -16}, {0, 0, 32}, {32, 0, 0}).build("floor"), floor_id);

  scene.images.push_back({.name = "leaf", .image = leaf_image()});
  ImageTexture leaf;
  leaf.image = ImageId(0);
  leaf.wrap_u = leaf.wrap_v = Wrap::clamp;
  DiffuseTransmissionMaterial leaf_model;
  const TextureId leaf_texture = add_texture(scene, {.name = "leaf", .node = leaf});
  leaf_model.reflectance = Color(0.7f);
  leaf_model.transmittance = Color(0.25f);
  leaf_model.reflectance.texture = leaf_model.transmittance.texture = leaf_texture;
  const MaterialId leaf_id = add_material(scene, "leaf", leaf_model);
  Material& material = scene.materials[leaf_id.index];
  material.alpha_mode = AlphaMode::mask;
  material.alpha.texture = leaf_texture;
  material.alpha.channel = 3;

  MeshBuilder leaves;
  for (int i = 0; i < s.leaves; ++i) {
    Seeded random(s.seed, static_cast<std::uint64_t>(i));
    const Vec3 outward = random.on_sphere();
    const Vec3 center = Vec3(0, 1.25f, 0) + outward * Vec3(1, 1.1f, 1) * random.uniform(0.55f, 1.f);
    const Vec3 along = normalize_or(outward + 0.7f * random.on_sphere(), {0, 1, 0});
    const Vec3 across = normalize_or(glm::cross(along, random.on_sphere()), {1, 0, 0});
    const float size = random.uniform(0.28f, 0.45f);
    leaves.quad(center - 0.5f * size * across, size * across, size * along);
  }
  if (s.leaves > 0) add_mesh(scene, leaves.build("leaves"), leaf_id);
  scene.lights.push_back(
      {.name = "sun",
       .shape = DirectionalLight{.direction = glm::normalize(Vec3(-0.6f, -1, -0.45f)), .irradiance = Color(3, 2.8f, 2.5f)},
       .node = {}});
  scene.environment = Environment{};
  scene.environment->scale = Color(0.45f, 0.55f, 0.75f);
  add_camera(scene, {1.2f, 1.9f, 4.6f}, {0, 1, 0}, 42);
  scene.hints.size_px = IVec2(800, 600);
  return scene;
}

}  // namespace

BuiltinScene textured_scene() {
  return declare<TexturedSettings, build_textured>("textured", "checkerboard floor and alpha-masked leaves");
}

}  // namespace sightline::builtin
