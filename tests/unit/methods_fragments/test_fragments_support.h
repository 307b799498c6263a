// Scenes with soft shadows, and the stages of the method one by one.
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "film/view.h"
#include "methods/fragments/area_light.h"
#include "methods/fragments/camera_pass.h"
#include "methods/fragments/pyramid.h"
#include "methods/fragments/refiner.h"
#include "support/studio.h"
#include "unit/trace/trace_scenes.h"
#include "visibility/visibility.h"

namespace sightline::test {

inline Camera camera_at(const Vec3& eye, const Vec3& target, float fov_rad) {
  Camera camera;
  const Vec3 back = glm::normalize(eye - target);
  const Vec3 right = glm::normalize(glm::cross(std::fabs(back.y) > 0.9f ? Vec3{0, 0, 1} : Vec3{0, 1, 0}, back));
  camera.world_from_camera = Mat4(Vec4(right, 0), Vec4(glm::cross(back, right), 0), Vec4(back, 0), Vec4(eye, 1));
  camera.fov_rad = fov_rad;
  return camera;
}

inline MaterialId add_material(Scene& scene, const SurfaceModel& model, const Color& emission = Color(0)) {
  Material material;
  material.model = model, material.emission.value = emission;
  scene.materials.push_back(material);
  return MaterialId(scene.materials.size() - 1);
}
inline void place(Scene& scene, Mesh mesh, MaterialId material) {
  mesh.materials = {material};
  place(scene, std::move(mesh));
}
/// A floor in the plane y = 0 that faces up.
inline Mesh floor_mesh(float half) {
  return make_mesh({{-half, 0, -half}, {-half, 0, half}, {half, 0, half}, {half, 0, -half}}, {{0, 1, 2}, {0, 2, 3}});
}
/// Emits downwards.
inline RectangleLight lamp(const Vec3& center, float half_width, const Color& radiance = Color(8)) {
  return {.center = center, .half_u = {half_width, 0, 0}, .half_v = {0, 0, half_width}, .radiance = radiance};
}

enum class Occluder { none, box, everything };
/// A floor under a camera that sees nothing else, without a light.
inline Scene bare_floor(Occluder occluder) {
  Scene scene;
  const MaterialId grey = add_material(scene, DiffuseMaterial{.reflectance = Color(0.6f, 0.5f, 0.4f)});
  place(scene, floor_mesh(20), grey);
  // Out of the camera's sight; only its shadow is in the picture.
  if (occluder == Occluder::box) place(scene, box_mesh({-0.5f, 2.2f, -0.5f}, {0.5f, 2.6f, 0.5f}), grey);
  if (occluder == Occluder::everything) place(scene, box_mesh({-30, 2.2f, -30}, {30, 2.6f, 30}), grey);
  scene.cameras.push_back(camera_at({0.3f, 2, 0.4f}, {0, 0, 0}, 1.2f));
  return scene;
}
inline Scene lamp_over_floor(Occluder occluder) {
  Scene scene = bare_floor(occluder);
  scene.lights.push_back({.name = "lamp", .shape = lamp({0.2f, 4, -0.1f}, 0.5f), .node = {}});
  return scene;
}
/// A box stands on the floor, with more surfaces than a floor has.
inline Scene box_on_floor() {
  Scene scene;
  const MaterialId grey = add_material(scene, DiffuseMaterial{.reflectance = Color(0.6f, 0.5f, 0.4f)});
  place(scene, floor_mesh(6), grey);
  place(scene, box_mesh({-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f}), add_material(scene, DiffuseMaterial{.reflectance = Color(0.3f, 0.6f, 0.4f)}));
  scene.cameras.push_back(camera_at({2.5f, 2.5f, 3}, {0, 0.3f, 0}, 0.9f));
  scene.lights.push_back({.name = "lamp", .shape = lamp({1, 3, -0.5f}, 0.4f), .node = {}});
  return scene;
}

/// A plate at height 2.2 whose edge runs through (0, 2.2, 0) in direction `angle`, between a floor and a lamp of half width `half`; the
/// camera looks down from below it. Floor and lamp are so large that nothing else is in the picture.
struct EdgeScene {
  static constexpr float kPlate = 2.2f, kLamp = 4;
  static constexpr float kGrazing = 3e-5f;  // rounding of rays and of what they hit
  float angle, half;
  Vec3 across() const { return {std::cos(angle), 0, std::sin(angle)}; }
  Scene scene() const {
    Scene scene = bare_floor(Occluder::none);
    scene.cameras = {camera_at({0, 2, 0}, {0, 0, 0}, 1.2f)};
    const Vec3 n = across(), along{-n.z, 0, n.x}, p{0, kPlate, 0};
    place(scene, make_mesh({p - 40.f * along, p + 40.f * along, p + 40.f * (along - n), p - 40.f * (along + n)}, {{0, 1, 2}, {0, 2, 3}}),
          MaterialId(0));
    scene.lights.push_back({.name = "lamp", .shape = lamp({0, kLamp, 0}, half), .node = {}});
    return scene;
  }
  /// How far on the free side of the edge the segment from a point of the floor to one of the lamp passes the plate's height.
  float clearance(const Vec3& floor, const Vec3& light) const {
    const float t = (kPlate - floor.y) / (light.y - floor.y);
    return glm::dot(floor + t * (light - floor), across());
  }
};

/// What stands before the refinement of a picture.
struct Stage {
  Shot shot;
  View view;
  std::unique_ptr<Visibility> visibility;
  GBuffer g;
  Vec3Batch radiance;
  std::vector<AreaLight> lights;
  PassStatistics statistics;

  Stage(Scene scene, IVec2 size_px)
      : shot(shot_of(std::move(scene), size_px)), view(shot.camera, size_px, PixelFilter(PixelFilter::Kind::centre)) {
    const VisibilityInfo& exact = find_visibility("exact");
    visibility = exact.make(shot.world, exact.settings, Context());
    visibility->begin_pass({0, 0}, Context());
    g.resize(size_px.x, size_px.y);
    radiance.resize(g.kind.size());
    CameraPass camera(*shot.world, view, 0, 64, CameraPass::Sampling::general, visibility.get());
    for (std::size_t root = 0; root < g.root_count(); ++root) camera.render(root, 0, g, radiance, statistics);
    lights = area_lights(shot.world->lights(), 16);
  }
  std::vector<Fragment> geometry(std::size_t root, const GeometryOptions& options = {}) const {
    DiscontinuityPyramid pyramid;
    std::vector<Fragment> fragments;
    pyramid.build(g, g.root(root), options);
    pyramid.refine(g, g.root(root), options, fragments);
    return fragments;
  }
  std::vector<std::vector<Fragment>> geometry_of_all(const GeometryOptions& options = {}) const {
    std::vector<std::vector<Fragment>> fragments;
    for (std::size_t root = 0; root < g.root_count(); ++root) fragments.push_back(geometry(root, options));
    return fragments;
  }
  bool interpolable(int x, int y) const {
    const PixelKind kind = g.kind[g.at(x, y)];
    return kind == PixelKind::diffuse || kind == PixelKind::analytic;
  }
};

/// Fragments that the levels of a signal describe: squares at multiples of their width whose pixels agree, and that hold nothing but
/// surfaces. Empty if they do not.
inline std::vector<Fragment> fragments_of(const Stage& stage, const LightSignal& signal) {
  std::vector<Fragment> fragments;
  const GBuffer& g = stage.g;
  for (int y = 0; y < g.height; ++y) {
    for (int x = 0; x < g.width; ++x) {
      if (!stage.interpolable(x, y)) continue;
      const Fragment f{static_cast<std::uint16_t>(x & -(1 << signal.level[g.at(x, y)])),
                       static_cast<std::uint16_t>(y & -(1 << signal.level[g.at(x, y)])), signal.level[g.at(x, y)]};
      if (f.level > kRootLevel || !stage.interpolable(f.x, f.y) || signal.level[g.at(f.x, f.y)] != f.level) return {};
      if (f.x != x || f.y != y) continue;
      for (int j = y; j < std::min(y + f.width(), g.height); ++j)
        for (int i = x; i < std::min(x + f.width(), g.width); ++i)
          if (signal.level[g.at(i, j)] != f.level || !stage.interpolable(i, j)) return {};
      fragments.push_back(f);
    }
  }
  return fragments;
}

}  // namespace sightline::test
