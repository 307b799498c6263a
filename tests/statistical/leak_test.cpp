// Detectors of leaks and acne: closed boxes must stay exactly black inside, and convex surfaces must not shadow themselves.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "scene/builtin/parts.h"
#include "scene/builtin/subdivide.h"
#include "support/studio.h"
#include "unit/trace/trace_scenes.h"

namespace sightline::test {
namespace {

using builtin::MeshBuilder;

/// Sizes and places that the house promises.
struct Placement {
  float factor;
  Vec3 by;
};
std::vector<Placement> placements() {
  return {{1, Vec3(0)}, {1e-3f, Vec3(0)}, {1e4f, Vec3(0)}, {1e7f, Vec3(0)}, {1, Vec3(1e4f)}, {1, Vec3(-1e4f, 1e4f, 0)}};
}
Scene placed(const Scene& scene, const Placement& placement) { return moved(scaled(scene, placement.factor), placement.by); }

enum class Shell { ball, box, turned_box };

/// A white room without a lamp, in blinding light from all sides.
Scene dark_room(Shell shell) {
  Scene scene;
  const MaterialId white = builtin::add_diffuse(scene, "white", Color(0.9f));
  // Faces share their vertices, so that the shell stays closed wherever it is moved and rounded.
  Mesh mesh = shell == Shell::ball ? MeshBuilder().ball(Vec3(0), 1, 24, true).build("shell") : box_mesh(Vec3(-1), Vec3(1));
  builtin::add_mesh(scene, std::move(mesh), white);
  if (shell == Shell::turned_box) scene.instances.back().world_from_object = glm::rotate(Mat4(1), 0.3f, Vec3(0.2f, 1, 0.1f));
  // Something inside, with many edges where it stands on the floor.
  builtin::add_mesh(scene, MeshBuilder().box({0.2f, -0.5f, 0}, {0.2f, 0.25f, 0.2f}, 0.7f).build("block"), white);
  scene.environment = Environment{};
  scene.environment->scale = Color(1e6f);
  scene.lights.push_back(
      {.name = "sun", .shape = DirectionalLight{.direction = glm::normalize(Vec3(1, -2, 0.5f)), .irradiance = Color(1e6f)}, .node = {}});
  scene.lights.push_back({.name = "bulb", .shape = PointLight{.position = {1.5f, 1.6f, -1.7f}, .intensity = Color(1e6f)}, .node = {}});
  scene.lights.push_back({.name = "panel",
                          .shape = RectangleLight{.center = {0, 2, 0}, .half_u = {1, 0, 0}, .half_v = {0, 0, 1}, .radiance = Color(1e6f)},
                          .node = {}});
  builtin::add_camera(scene, {-0.5f, 0.1f, 0.3f}, {0.3f, -0.4f, -0.1f}, 90);
  return scene;
}

constexpr IVec2 kRoomSize{48, 48};

int leaking_pixels(const Scene& scene, Picture* picture = nullptr) {
  Picture taken = expose(shot_of(scene, kRoomSize), {.spp = 8, .max_bounces = 6, .filter = PixelFilter::Kind::gaussian});
  int leaks = 0;
  for (std::uint32_t pixel = 0; pixel < kRoomSize.x * kRoomSize.y; ++pixel) leaks += !is_black(taken.frame.color(pixel));
  if (picture) *picture = std::move(taken);
  return leaks;
}

TEST(Leak, AClosedRoomIsExactlyBlack) {
  for (const Shell shell : {Shell::ball, Shell::box, Shell::turned_box}) {
    for (const Placement& placement : placements()) {
      if (shell != Shell::ball && placement.by != Vec3(0)) continue;  // see below
      Picture picture{Frame(1, 1, {}), {}};
      EXPECT_EQ(leaking_pixels(placed(dark_room(shell), placement), &picture), 0)
          << "shell " << static_cast<int>(shell) << " times " << placement.factor << " moved by " << placement.by.x;
      EXPECT_GT(picture.statistics.rays.occlusion, 48u * 48 * 8) << "nobody asked for light";
    }
  }
}

TEST(Leak, FarFromTheOriginEdgesOfRoomsAreTight) {
  // At 1e4 neighbouring floats are 1e-3 apart: a hit nearer than half of that to an edge of 90 degrees would be rounded onto the other
  // wall, off which moving along its own normal does not take it. It is kept its error bound away from the edge instead.
  for (const Shell shell : {Shell::box, Shell::turned_box}) {
    EXPECT_EQ(leaking_pixels(placed(dark_room(shell), {1, Vec3(1e4f)})), 0);
  }
}

TEST(Leak, TheDetectorSeesAHole) {
  Scene scene = dark_room(Shell::box);
  std::vector<UVec3> triangles(scene.meshes[0].triangles.begin(), scene.meshes[0].triangles.end());
  triangles.pop_back();
  scene.meshes[0].triangles = triangles;
  EXPECT_GT(leaking_pixels(scene), 100);
}

/// Every pixel of a convex body under one light shows the light that its normal asks for: none is shadowed, none is lit from behind.
void expect_unshadowed(const Scene& scene, const Vec3& towards_light, float least_cosine, const std::string& what) {
  const Shot shot = shot_of(scene, {96, 96});
  const Picture picture =
      expose(shot, {.settings = {"mode=one-hit"}, .spp = 1, .light_samples = 1, .max_bounces = 0, .aovs = parse_aovs("normal,surface")});
  int object = 0, wrong = 0, lit = 0;
  for (std::uint32_t pixel = 0; pixel < 96 * 96; ++pixel) {
    if (picture.frame.value(Aov::surface, pixel).x == 0) continue;
    ++object;
    const float cosine = glm::dot(picture.frame.value(Aov::normal, pixel), towards_light);
    if (std::fabs(cosine) < least_cosine) continue;
    const double truth = cosine > 0 ? 0.7 / std::numbers::pi * 3 * cosine : 0;
    lit += cosine > 0;
    wrong += std::fabs(picture.frame.color(pixel).y - truth) > 1e-4 * truth + 1e-6;
  }
  EXPECT_EQ(wrong, 0) << what;
  EXPECT_GT(object, 500) << what;
  EXPECT_GT(lit, 100) << what;
}

DirectionalLight sun(const Vec3& towards_light) { return {.direction = -towards_light, .irradiance = Color(3)}; }

TEST(Acne, AFinelyDividedFloorInGrazingLightIsEvenlyLit) {
  for (const float elevation : {1.f, 0.1f, 0.01f}) {
    const Vec3 towards_light = glm::normalize(Vec3(0.8f, elevation, 0.6f));
    for (const Placement& placement : placements()) {
      Scene scene;
      builtin::add_mesh(scene, MeshBuilder().quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}).build("floor"),
                        builtin::add_diffuse(scene, "floor", Color(0.7f)));
      builtin::subdivide(scene, 10000, Context());
      scene.lights.push_back({.name = "sun", .shape = sun(towards_light), .node = {}});
      builtin::add_camera(scene, {0.5f, 1.5f, 2}, Vec3(0), 40);
      expect_unshadowed(placed(scene, placement), towards_light, 0,
                        "elevation " + std::to_string(elevation) + " times " + std::to_string(placement.factor) + " moved by " +
                            std::to_string(placement.by.x));
    }
  }
}

TEST(Acne, ConvexBallsDoNotShadowThemselves) {
  const Vec3 towards_light = glm::normalize(Vec3(1, 0.7f, 0.5f));
  for (const bool mesh : {false, true}) {
    for (const Placement& placement : placements()) {
      Scene scene;
      const MaterialId grey = builtin::add_diffuse(scene, "grey", Color(0.7f));
      if (mesh) {
        builtin::add_mesh(scene, MeshBuilder().ball(Vec3(0), 1, 48).build("ball"), grey);
      } else {
        builtin::add_sphere(scene, "ball", Vec3(0), 1, grey);
      }
      scene.lights.push_back({.name = "sun", .shape = sun(towards_light), .node = {}});
      builtin::add_camera(scene, {0.5f, 0.4f, 4}, Vec3(0), 34);
      // Vertices at 1e4 are rounded by 1e-3, so that facets lean by up to a few hundredths and hide each other near the terminator.
      const float least_cosine = placement.by.x == 0 ? 1e-4f : mesh ? 0.15f : 0.01f;
      expect_unshadowed(placed(scene, placement), towards_light, least_cosine,
                        std::string(mesh ? "mesh" : "sphere") + " times " + std::to_string(placement.factor) + " moved by " +
                            std::to_string(placement.by.x));
    }
  }
}

}  // namespace
}  // namespace sightline::test
