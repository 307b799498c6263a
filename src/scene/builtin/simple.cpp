// Small scenes for tests and first steps.
#include <cmath>

#include "scene/builtin/parts.h"
#include "scene/builtin/scenes.h"

namespace sightline::builtin {
namespace {

struct QuadSettings {
  float reflectance = 0.7f, intensity = 10;
  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("reflectance", &QuadSettings::reflectance, {.help = "of the quad", .minimum = 0, .maximum = 1});
    visit("intensity", &QuadSettings::intensity, {.help = "of the point light 2 above its centre", .minimum = 0, .unit = "W/sr"});
  }
};

Scene build_quad(const QuadSettings& s, const LoadOptions&, const Context&) {
  Scene scene;
  add_mesh(scene, MeshBuilder().quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}).build("quad"), add_diffuse(scene, "grey", Color(s.reflectance)));
  scene.lights.push_back({.name = "light", .shape = PointLight{.position = {0, 2, 0}, .intensity = Color(s.intensity)}, .node = {}});
  add_camera(scene, {0, 2, 3}, Vec3(0), 45);
  scene.hints.size_px = IVec2(400, 400);
  return scene;
}

struct TwoQuadsSettings {
  float distance = 1, size = 1, radiance = 1, reflectance = 0.5f;
  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("distance", &TwoQuadsSettings::distance, {.help = "between the parallel squares", .minimum = 1e-4});
    visit("size", &TwoQuadsSettings::size, {.help = "edge of both squares", .minimum = 1e-4});
    visit("radiance", &TwoQuadsSettings::radiance, {.help = "of the upper square", .minimum = 0});
    visit("reflectance", &TwoQuadsSettings::reflectance,
          {.help = "of the lower square; the upper one is black", .minimum = 0, .maximum = 1});
  }
};

Scene build_two_quads(const TwoQuadsSettings& s, const LoadOptions&, const Context&) {
  Scene scene;
  const float h = s.size / 2;
  const Vec3 x(s.size, 0, 0), z(0, 0, s.size);
  add_mesh(scene, MeshBuilder().quad({-h, 0, -h}, z, x).build("receiver"), add_diffuse(scene, "receiver", Color(s.reflectance)));
  add_mesh(scene, MeshBuilder().quad({-h, s.distance, -h}, x, z).build("emitter"), add_emitter(scene, "emitter", Color(s.radiance)));
  add_camera(scene, {0, 0.6f * s.distance, 2.2f * std::fmax(s.size, s.distance)}, {0, 0.25f * s.distance, 0}, 40);
  scene.hints.size_px = IVec2(400, 400);
  return scene;
}

enum class ShadowLight { area, point, directional };
struct HalfPlaneSettings {
  ShadowLight light = ShadowLight::area;
  float light_size = 0.5f;
  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("light", &HalfPlaneSettings::light, {.help = "what casts the shadow", .choices = {"area", "point", "directional"}});
    visit("light_size", &HalfPlaneSettings::light_size, {.help = "edge of the square area light", .minimum = 1e-4});
  }
};

/// The plate at y = 1 covers x < 0; the light is at (0, 2, 0), so the shadow's edge lies at x = 0 on the floor.
Scene build_half_plane(const HalfPlaneSettings& s, const LoadOptions&, const Context&) {
  Scene scene;
  const MaterialId floor = add_diffuse(scene, "floor", Color(0.7f));
  add_mesh(scene, MeshBuilder().quad({-4, 0, -4}, {0, 0, 8}, {8, 0, 0}).build("floor"), floor);
  add_mesh(scene, MeshBuilder().quad({-40, 1, -40}, {0, 0, 80}, {40, 0, 0}).build("plate"), add_diffuse(scene, "plate", Color(0.1f)));
  Light light{.name = "light", .shape = PointLight{.position = {0, 2, 0}, .intensity = Color(10)}, .node = {}};
  if (s.light == ShadowLight::directional) light.shape = DirectionalLight{.direction = {0, -1, 0}, .irradiance = Color(3)};
  if (s.light == ShadowLight::area) {
    const float h = s.light_size / 2;
    light.shape = RectangleLight{
        .center = {0, 2, 0}, .half_u = {h, 0, 0}, .half_v = {0, 0, h}, .radiance = Color(10 / (s.light_size * s.light_size))};
  }
  scene.lights.push_back(std::move(light));
  add_camera(scene, {2.5f, 0.9f, 0}, {0, 0, 0}, 60);
  scene.hints.size_px = IVec2(512, 384);
  return scene;
}

struct NoSettings {
  template <class Visitor>
  static void describe(Visitor&&) {}
};

Scene build_spheres(const NoSettings&, const LoadOptions&, const Context&) {
  Scene scene;
  const MaterialId floor = add_diffuse(scene, "floor", Color(0.5f));
  add_mesh(scene, MeshBuilder().quad({-12, 0, -12}, {0, 0, 24}, {24, 0, 0}).build("floor"), floor);
  ConductorMaterial gold;
  gold.eta = Color(0.143f, 0.374f, 1.442f);
  gold.k = Color(3.983f, 2.386f, 1.603f);
  gold.alpha_u = gold.alpha_v = 0.15f;
  const SurfaceModel models[] = {
      DiffuseMaterial{.reflectance = Color(0.65f, 0.2f, 0.15f)},
      MetallicRoughnessMaterial{.base_color = Color(0.2f, 0.35f, 0.7f), .metallic = 0.f, .roughness = 0.3f},
      gold,
      CoatedDiffuseMaterial{.reflectance = Color(0.15f, 0.45f, 0.2f), .eta = 1.5f, .alpha_u = 0.01f, .alpha_v = 0.01f},
      PhongMaterial{.diffuse = Color(0.4f, 0.2f, 0.5f), .specular = Color(0.3f), .exponent = 60.f},
      DielectricMaterial{.eta = 1.5f},
  };
  for (int i = 0; i < 6; ++i) {
    const MaterialId material = add_material(scene, "ball " + std::to_string(i + 1), models[i]);
    const Vec3 center(2.3f * (static_cast<float>(i % 3) - 1), 1, i < 3 ? -2.4f : 0.f);
    add_sphere(scene, scene.materials[material.index].name, center, 1, material);
  }
  add_mesh(scene, MeshBuilder().quad({-2, 6, 0}, {4, 0, 0}, {0, 0, 4}).build("light"), add_emitter(scene, "light", Color(9)));
  scene.environment = Environment{};
  scene.environment->scale = Color(0.35f, 0.4f, 0.5f);
  add_camera(scene, {0, 3.6f, 8.5f}, {0, 0.8f, -1}, 34);
  scene.hints.size_px = IVec2(800, 600);
  return scene;
}

/// Four glossy plates of growing roughness under four balls of growing size [Veach1995].
Scene build_veach_like(const NoSettings&, const LoadOptions&, const Context&) {
  Scene scene;
  MeshBuilder shell;
  shell.quad({-20, -4, -12}, {0, 0, 40}, {40, 0, 0}).quad({-20, -4, -5}, {40, 0, 0}, {0, 20, 0});
  add_mesh(scene, shell.build("floor and wall"), add_diffuse(scene, "grey", Color(0.4f)));

  const Vec3 eye(0, 1.5f, 12);
  const float alphas[] = {0.005f, 0.02f, 0.05f, 0.1f};
  const float radii[] = {0.033f, 0.1f, 0.3f, 0.9f};
  for (int i = 0; i < 4; ++i) {
    const auto step = static_cast<float>(i);
    ConductorMaterial metal;
    metal.eta = Color(0.2f);
    metal.k = Color(3.9f);
    metal.reflectance_tint = Color(0.4f);
    metal.alpha_u = metal.alpha_v = alphas[i];
    const MaterialId material = add_material(scene, "plate " + std::to_string(i + 1), metal);
    // Each plate is tilted so that it mirrors the row of balls towards the eye.
    const Vec3 center(0, -2.9f + 0.26f * step * step, 3.6f - 1.7f * step);
    const Vec3 normal = glm::normalize(glm::normalize(eye - center) + glm::normalize(Vec3(0, 3.4f, 0) - center));
    const Vec3 x(1, 0, 0), v = glm::cross(normal, x);
    add_mesh(scene, MeshBuilder().quad(center - 3.4f * x - 0.62f * v, 6.8f * x, 1.24f * v).build("plate " + std::to_string(i + 1)),
             material);
    // Equal power: radiance falls with the square of the radius.
    const Color tint[] = {{1, 0.8f, 0.5f}, {0.7f, 1, 0.6f}, {0.5f, 0.8f, 1}, {1, 0.6f, 0.8f}};
    add_sphere(scene, "ball " + std::to_string(i + 1), {-3.75f + 2.5f * step, 3.4f, 0}, radii[i],
               add_emitter(scene, "light " + std::to_string(i + 1), 1.6f / (radii[i] * radii[i]) * tint[i]));
  }
  add_camera(scene, eye, {0, -0.2f, 0}, 34);
  scene.hints.size_px = IVec2(768, 512);
  return scene;
}

}  // namespace

BuiltinScene quad_scene() { return declare<QuadSettings, build_quad>("quad", "one square below a point light"); }
BuiltinScene two_quads_scene() {
  return declare<TwoQuadsSettings, build_two_quads>("two-quads", "a square below a glowing square: form factors");
}
BuiltinScene half_plane_scene() {
  return declare<HalfPlaneSettings, build_half_plane>("half-plane", "shadow of a straight edge, soft or hard");
}
BuiltinScene spheres_scene() { return declare<NoSettings, build_spheres>("spheres", "six balls of six materials"); }
BuiltinScene veach_like_scene() {
  return declare<NoSettings, build_veach_like>("veach-like", "glossy plates and lights of many sizes: multiple importance sampling");
}

}  // namespace sightline::builtin
