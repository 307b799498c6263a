// A box with two coloured walls and two blocks, after [Goral1984]; proportions and camera of the box as it was measured at Cornell, in
// units of half its width.
#include "scene/builtin/parts.h"
#include "scene/builtin/scenes.h"

namespace sightline::builtin {
namespace {

struct CornellSettings {
  bool blocks = true;
  float radiance = 16;

  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("blocks", &CornellSettings::blocks, {.help = "the two blocks inside"});
    visit("radiance", &CornellSettings::radiance, {.help = "of the ceiling light", .minimum = 0, .unit = "W/(sr m^2)"});
  }
};

struct GlassSettings {
  float radiance = 16;

  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("radiance", &GlassSettings::radiance, {.help = "of the ceiling light", .minimum = 0, .unit = "W/(sr m^2)"});
  }
};

/// Walls, light and camera. The box spans [-1,1] x [0,2] x [-1,1] and is open towards +z.
Scene empty_box(float radiance) {
  Scene scene;
  const MaterialId white = add_diffuse(scene, "white", Color(0.73f));
  const MaterialId red = add_diffuse(scene, "red", Color(0.60f, 0.06f, 0.05f));
  const MaterialId green = add_diffuse(scene, "green", Color(0.13f, 0.42f, 0.09f));
  const MaterialId light = add_emitter(scene, "light", radiance * Color(1, 0.78f, 0.46f));

  const Vec3 x(2, 0, 0), y(0, 2, 0), z(0, 0, 2);
  MeshBuilder shell;
  shell.quad({-1, 0, -1}, z, x);  // floor
  shell.quad({-1, 2, -1}, x, z);  // ceiling
  shell.quad({-1, 0, -1}, x, y);  // back wall
  add_mesh(scene, shell.build("shell"), white);
  add_mesh(scene, MeshBuilder().quad({-1, 0, -1}, y, z).build("left wall"), red);
  add_mesh(scene, MeshBuilder().quad({1, 0, -1}, z, y).build("right wall"), green);
  // 130 x 105 mm of a box 556 mm wide, a little below the ceiling.
  const Vec3 half_x(0.234f, 0, 0), half_z(0, 0, 0.189f);
  add_mesh(scene, MeshBuilder().quad(Vec3(0, 1.995f, 0) - half_x - half_z, 2.f * half_x, 2.f * half_z).build("light"), light);

  add_camera(scene, {0, 1, 3.88f}, {0, 1, 0}, 39.3f);
  scene.hints.size_px = IVec2(600, 600);
  return scene;
}

Scene build_cornell(const CornellSettings& settings, const LoadOptions&, const Context&) {
  Scene scene = empty_box(settings.radiance);
  if (settings.blocks) {
    constexpr float kTurn = 17.0f * kPi / 180;
    MeshBuilder blocks;
    blocks.box({0.33f, 0.297f, 0.40f}, {0.297f, 0.297f, 0.297f}, -kTurn);
    blocks.box({-0.325f, 0.594f, -0.257f}, {0.297f, 0.594f, 0.297f}, kTurn);
    add_mesh(scene, blocks.build("blocks"), MaterialId(0));
  }
  return scene;
}

Scene build_glass(const GlassSettings& settings, const LoadOptions&, const Context&) {
  Scene scene = empty_box(settings.radiance);
  const MaterialId glass = add_material(scene, "glass", DielectricMaterial{.eta = 1.5f});
  ConductorMaterial silver;
  silver.eta = Color(0.155f, 0.116f, 0.138f);
  silver.k = Color(4.83f, 3.12f, 2.15f);
  const MaterialId mirror = add_material(scene, "silver", silver);
  add_sphere(scene, "mirror ball", {-0.42f, 0.42f, -0.30f}, 0.42f, mirror);
  add_sphere(scene, "glass ball", {0.42f, 0.42f, 0.32f}, 0.42f, glass);
  return scene;
}

}  // namespace

BuiltinScene cornell_scene() { return declare<CornellSettings, build_cornell>("cornell", "box with two coloured walls and two blocks"); }
BuiltinScene glass_scene() { return declare<GlassSettings, build_glass>("glass", "the cornell box with a glass and a mirror ball"); }

}  // namespace sightline::builtin
