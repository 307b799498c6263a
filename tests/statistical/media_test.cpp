// Light through absorbing media against Beer and Lambert, and all methods against each other.
#include <gtest/gtest.h>

#include <cmath>

#include "scene/builtin/parts.h"
#include "support/picture_statistics.h"

namespace sightline::test {
namespace {

constexpr double kFamily = 1e-3;
const char* const kMethods[] = {"reference", "bidirectional", "visibility-cache"};
const Color kInk{0.2f, 0.7f, 1.5f}, kTea{0.4f, 0.1f, 0.05f};

MaterialId add_boundary(Scene& scene, const std::string& name, const Color& sigma_a, const SurfaceModel& model = InterfaceMaterial{}) {
  const MaterialId id = builtin::add_material(scene, name, model);
  scene.media.push_back({.name = name, .sigma_a = sigma_a});
  scene.materials[id.index].interior = MediumId(scene.media.size() - 1);
  return id;
}

void add_box(Scene& scene, const std::string& name, const Vec3& center, const Vec3& half, MaterialId material) {
  builtin::add_mesh(scene, builtin::MeshBuilder().box(center, half).build(name), material);
}

/// A floor of reflectance 0.5 at y = 0, seen from above.
Scene floor_seen_from(const Vec3& eye) {
  Scene scene;
  builtin::add_mesh(scene, builtin::MeshBuilder().quad({-20, 0, -20}, {0, 0, 40}, {40, 0, 0}).build("floor"),
                    builtin::add_diffuse(scene, "floor", Color(0.5f)));
  builtin::add_camera(scene, eye, {0.3f, 0, 0.2f}, 40);
  return scene;
}

void add_point_light(Scene& scene, const Vec3& position) {
  scene.lights.push_back({.name = "lamp", .shape = PointLight{position, Color(5)}, .node = {}});
}

/// Length of the segment from a to b inside an upright slab.
float inside_slab(const Vec3& a, const Vec3& b, float low, float high) {
  const float y0 = std::fmin(a.y, b.y), y1 = std::fmax(a.y, b.y);
  return std::fmax(0.f, std::fmin(y1, high) - std::fmax(y0, low)) / (y1 - y0) * glm::length(b - a);
}

/// Direct light of the point light on the floor is what `left(floor point, light, eye)` leaves of it, at every pixel.
template <class Left>
void expect_floor(const std::string& name, const Scene& scene, const Vec3& light, Left left) {
  const Shot shot = shot_of(scene, {9, 7});
  for (const char* method : kMethods) {
    const Picture picture = expose(shot, {.method = method, .spp = 2, .max_bounces = 0});
    for (std::uint32_t pixel = 0; pixel < 63; ++pixel) {
      Vec3 eye, direction;
      centre_ray(shot, pixel, eye, direction);
      const Vec3 p = eye - eye.y / direction.y * direction, to = light - p;
      const float distance = glm::length(to);
      const Color expected = Color(5) * (0.5f * kInvPi * to.y / (distance * distance * distance)) * left(p, light, eye);
      const Color seen = picture.frame.color(pixel);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], expected[c], 2e-4f * expected[c] + 1e-7f) << name << ", " << method << ", " << pixel;
    }
  }
}

TEST(Media, AGlowingBallInAnAbsorbingOneFadesExponentially) {
  // Mesh or sphere as the boundary, and one more shell around: none of them is a bounce.
  for (const bool mesh : {false, true}) {
    Scene scene;
    builtin::add_sphere(scene, "lamp", Vec3(0), 0.5f, builtin::add_emitter(scene, "lamp", Color(3)));
    const MaterialId ink = add_boundary(scene, "ink", kInk);
    if (mesh)
      add_box(scene, "ink", Vec3(0), Vec3(2), ink);
    else
      builtin::add_sphere(scene, "ink", Vec3(0), 2, ink);
    add_box(scene, "nothing", {0, 0, 4}, {2, 2, 0.2f}, builtin::add_material(scene, "nothing", InterfaceMaterial{}));
    add_box(scene, "tea", {0, 0, 3}, {2, 2, 0.25f}, add_boundary(scene, "tea", kTea));
    builtin::add_camera(scene, {0, 0, 6}, Vec3(0), 1);
    const Shot shot = shot_of(scene, {1, 1});
    for (const char* method : kMethods) {
      const Color seen = expose(shot, {.method = method, .spp = 4, .max_bounces = 0}).frame.color(0);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(seen[c], 3 * std::exp(-1.5f * kInk[c] - 0.5f * kTea[c]), 1e-4f) << method << (mesh ? ", box" : ", ball");
    }
  }
}

TEST(Media, LightSamplesFadeBetweenInterfaces) {
  const Vec3 light{0.4f, 3, -0.3f};
  // A lamp inside a ball: as far as its radius, whatever the direction.
  Scene ball = floor_seen_from({0.5f, 4, 6});
  add_point_light(ball, light);
  builtin::add_sphere(ball, "ink", light, 0.8f, add_boundary(ball, "ink", kInk));
  expect_floor("ball", ball, light, [](const Vec3&, const Vec3&, const Vec3&) { return glm::exp(-0.8f * kInk); });
  // Two slabs below the lamp, the camera between them.
  Scene slabs = floor_seen_from({0.5f, 1.7f, 3});
  add_point_light(slabs, light);
  add_box(slabs, "ink", {0, 2.3f, 0}, {8, 0.2f, 8}, add_boundary(slabs, "ink", kInk));
  add_box(slabs, "tea", {0, 1, 0}, {8, 0.3f, 8}, add_boundary(slabs, "tea", kTea));
  expect_floor("slabs", slabs, light, [](const Vec3& p, const Vec3& l, const Vec3& eye) {
    return glm::exp(-kInk * inside_slab(p, l, 2.1f, 2.5f) - kTea * (inside_slab(p, l, 0.7f, 1.3f) + inside_slab(p, eye, 0.7f, 1.3f)));
  });
}

TEST(Media, WhatLiesInsideIsLitAndSeenThroughTheMedium) {
  const Vec3 light{0.4f, 3, -0.3f};
  const auto all_the_way = [](const Vec3& p, const Vec3& l, const Vec3& eye) {
    return glm::exp(-kInk * (glm::length(l - p) + glm::length(eye - p)));
  };
  // Camera, lamp and floor in one medium, bounded by an interface or by walls of glass.
  for (const bool glass : {false, true}) {
    const SurfaceModel model = glass ? SurfaceModel(DielectricMaterial{.eta = 1.5f}) : SurfaceModel(InterfaceMaterial{});
    Scene scene = floor_seen_from({0.5f, 4, 6});
    add_point_light(scene, light);
    add_box(scene, "ink", {0, 2, 0}, Vec3(30), add_boundary(scene, "ink", kInk, model));
    expect_floor(glass ? "in glass" : "in an interface", scene, light, all_the_way);
  }
  // A surface of the liquid between camera and floor: the lamp is below it.
  Scene pool = floor_seen_from({0.5f, 4, 6});
  add_point_light(pool, light);
  add_box(pool, "ink", {0, 1, 0}, {12, 2.5f, 12}, add_boundary(pool, "ink", kInk));
  expect_floor("pool", pool, light, [](const Vec3& p, const Vec3& l, const Vec3& eye) {
    return glm::exp(-kInk * (glm::length(l - p) + inside_slab(p, eye, -1, 3.5f)));
  });
}

/// A lamp, a ball and a wall, some in ink, under a sky.
Scene still_life(const SurfaceModel& boundary, bool sky) {
  Scene scene = floor_seen_from({0.5f, 2.5f, 5});
  builtin::add_mesh(scene, builtin::MeshBuilder().quad({-3, 0, -2}, {6, 0, 0}, {0, 4, 0}).build("wall"),
                    builtin::add_diffuse(scene, "wall", Color(0.7f)));
  const MaterialId ball = builtin::add_material(scene, "ball", MetallicRoughnessMaterial{.base_color = Color(0.8f), .roughness = 0.5f});
  builtin::add_sphere(scene, "ball", {0, 0.8f, 0}, 0.5f, ball);
  builtin::add_sphere(scene, "ink", {0, 1, 0}, 0.9f, add_boundary(scene, "ink", kInk, boundary));
  add_box(scene, "lamp", {1.5f, 2.2f, 0}, Vec3(0.3f), builtin::add_emitter(scene, "lamp", Color(8)));
  add_box(scene, "tea", {1.5f, 2.2f, 0}, Vec3(0.6f), add_boundary(scene, "tea", kTea));
  if (sky) scene.environment = Environment{}, scene.environment->scale = Color(0.3f, 0.4f, 0.5f);
  return scene;
}

void expect_same(const Replicates& a, const Replicates& b, const std::string& name) {
  const PictureTest test = compare(a, b);
  const std::string text =
      name + ": means " + std::to_string(a.picture_mean.y) + ", " + std::to_string(b.picture_mean.y) + "; " + test.worst;
  EXPECT_GT(test.pixel_p, kFamily) << text;
  EXPECT_GT(test.mean_p, kFamily) << text;
}

TEST(Media, TechniquesAndMethodsAgree) {
  const SurfaceModel boundaries[] = {InterfaceMaterial{}, DielectricMaterial{.eta = 1.2f, .alpha_u = 0.2f, .alpha_v = 0.2f}};
  for (const SurfaceModel& boundary : boundaries) {
    for (const bool sky : {false, true}) {
      const Shot shot = shot_of(still_life(boundary, sky), {10, 8});
      const std::string name = std::string(boundary.index() == SurfaceModel(InterfaceMaterial{}).index() ? "interface" : "rough glass") +
                               (sky ? " under a sky" : "");
      const Replicates reference = replicate(shot, {.spp = 96, .max_bounces = 4, .seed = 1}, 24);
      expect_same(reference, replicate(shot, {.spp = 96, .max_bounces = 4, .bsdf_only = true, .seed = 2}, 24), name + ", BSDF alone");
      expect_same(reference, replicate(shot, {.spp = 24, .light_samples = 4, .max_bounces = 4, .seed = 3}, 24), name + ", 4 light samples");
      expect_same(reference, replicate(shot, {.method = "bidirectional", .spp = 32, .max_bounces = 4, .seed = 4}, 24),
                  name + ", bidirectional");
    }
  }
}

// Direct light alone: virtual lights and rough glass are its approximations.
TEST(Media, DirectLightOfTheVisibilityCacheMethodIsTheReferences) {
  Scene scene = still_life(InterfaceMaterial{}, true);
  const Shot shot = shot_of(scene, {10, 8});
  const Replicates reference = replicate(shot, {.spp = 128, .max_bounces = 0, .seed = 1}, 24);
  expect_same(reference, replicate(shot, {.method = "visibility-cache", .spp = 8, .max_bounces = 0, .seed = 2}, 24), "visibility-cache");
}

}  // namespace
}  // namespace sightline::test
