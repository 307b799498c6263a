// Scenes of known radiance: an object under a constant sky, and closed shells that emit and reflect.
#include <cmath>

#include "scene/builtin/parts.h"
#include "scene/builtin/scenes.h"

namespace sightline::builtin {
namespace {

enum class Model { diffuse, metallic_roughness, conductor, dielectric, coated_diffuse, phong, diffuse_transmission };
enum class Shape { sphere, mesh, box };

struct FurnaceSettings {
  Model model = Model::diffuse;
  Shape shape = Shape::sphere;
  float albedo = 0.7f, roughness = 0.5f, metallic = 1, eta = 1.5f, exponent = 32, radiance = 1;

  template <class Visitor>
  static void describe(Visitor&& visit) {
    using S = FurnaceSettings;
    visit("model", &S::model,
          {.help = "reflectance of the object",
           .choices = {"diffuse", "metallic-roughness", "conductor", "dielectric", "coated-diffuse", "phong", "diffuse-transmission"}});
    visit("shape", &S::shape,
          {.help = "ball under the sky, the same as a mesh, or the inside of a closed glowing box", .choices = {"sphere", "mesh", "box"}});
    visit("albedo", &S::albedo, {.help = "reflectance parameter of the model", .minimum = 0, .maximum = 1});
    visit("roughness", &S::roughness, {.help = "0 is smooth; GGX alpha is its square", .minimum = 0, .maximum = 1});
    visit("metallic", &S::metallic, {.help = "of metallic-roughness", .minimum = 0, .maximum = 1});
    visit("eta", &S::eta, {.help = "refractive index of dielectric and coat", .minimum = 1, .maximum = 4});
    visit("exponent", &S::exponent, {.help = "of phong", .minimum = 1});
    visit("radiance", &S::radiance, {.help = "of the sky; in the box, what every ray must return", .minimum = 0});
  }
};

SurfaceModel surface(const FurnaceSettings& s) {
  const float alpha = s.roughness * s.roughness;
  const Color albedo(s.albedo);
  switch (s.model) {
    case Model::diffuse:
      break;
    case Model::metallic_roughness:
      return MetallicRoughnessMaterial{.base_color = albedo, .metallic = s.metallic, .roughness = s.roughness};
    case Model::conductor: {
      // A purely imaginary index reflects everything at every angle; the tint alone decides.
      ConductorMaterial metal;
      metal.eta = Color(0);
      metal.k = Color(1);
      metal.reflectance_tint = albedo;
      metal.alpha_u = metal.alpha_v = alpha;
      return metal;
    }
    case Model::dielectric:
      return DielectricMaterial{.eta = s.eta, .alpha_u = alpha, .alpha_v = alpha};
    case Model::coated_diffuse:
      return CoatedDiffuseMaterial{.reflectance = albedo, .eta = s.eta, .alpha_u = alpha, .alpha_v = alpha};
    case Model::phong:
      return PhongMaterial{.diffuse = 0.5f * albedo, .specular = 0.5f * albedo, .exponent = s.exponent};
    case Model::diffuse_transmission:
      return DiffuseTransmissionMaterial{.reflectance = 0.5f * albedo, .transmittance = 0.5f * albedo};
  }
  return DiffuseMaterial{.reflectance = albedo};
}

Scene build_furnace(const FurnaceSettings& s, const LoadOptions&, const Context&) {
  Scene scene;
  const MaterialId material = add_material(scene, "furnace", surface(s));
  scene.hints.size_px = IVec2(256, 256);
  if (s.shape == Shape::box) {
    // Every wall emits what reflection loses: radiance is the same everywhere, in every direction (for a Lambertian surface).
    scene.materials[0].emission = Color(s.radiance * (1 - s.albedo));
    scene.materials[0].emission_two_sided = true;
    add_mesh(scene, MeshBuilder().box(Vec3(0), Vec3(1)).build("furnace"), material);
    add_camera(scene, {0.3f, 0.2f, 0.4f}, {0, 0, -0.5f}, 60);
    return scene;
  }
  scene.environment = Environment{};
  scene.environment->scale = Color(s.radiance);
  if (s.shape == Shape::sphere) {
    add_sphere(scene, "ball", Vec3(0), 1, material);
  } else {
    add_mesh(scene, MeshBuilder().ball(Vec3(0), 1, 64).build("ball"), material);
  }
  add_camera(scene, {0, 0, 4}, Vec3(0), 34);
  return scene;
}

struct LitSphereSettings {
  float albedo = 0.5f, emission = 1;
  bool mesh = false;

  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("albedo", &LitSphereSettings::albedo, {.help = "of the wall", .minimum = 0, .maximum = 0.99});
    visit("emission", &LitSphereSettings::emission,
          {.help = "radiance the wall emits; every ray returns emission / (1 - albedo)", .minimum = 0});
    visit("mesh", &LitSphereSettings::mesh, {.help = "a triangulated ball instead of an exact one"});
  }
};

Scene build_lit_sphere(const LitSphereSettings& s, const LoadOptions&, const Context&) {
  Scene scene;
  const MaterialId wall = add_diffuse(scene, "wall", Color(s.albedo));
  scene.materials[wall.index].emission = Color(s.emission);
  if (s.mesh) {
    add_mesh(scene, MeshBuilder().ball(Vec3(0), 1, 32, true).build("ball"), wall);
  } else {
    add_sphere(scene, "ball", Vec3(0), 1, wall, true);
  }
  add_camera(scene, {0.2f, 0.1f, 0.3f}, {0, 0, -1}, 60);
  scene.hints.size_px = IVec2(256, 256);
  return scene;
}

}  // namespace

BuiltinScene furnace_scene() {
  return declare<FurnaceSettings, build_furnace>("furnace",
                                                 "an object of a chosen reflectance under a constant sky, or a closed glowing box");
}
BuiltinScene lit_sphere_inside_scene() {
  return declare<LitSphereSettings, build_lit_sphere>("lit-sphere-inside",
                                                      "inside of an emitting, reflecting ball: the same radiance everywhere");
}

}  // namespace sightline::builtin
