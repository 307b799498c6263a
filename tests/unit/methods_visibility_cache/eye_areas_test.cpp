// The areas that eye samples stand for add up to the area that is seen.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "unit/methods_visibility_cache/eye_scenes.h"

namespace sightline {
namespace {

using namespace test;

std::shared_ptr<const World> build(const Scene& scene) { return World::build(scene, {}, Context()); }

double triangle_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  return 0.5 * static_cast<double>(glm::length(glm::cross(b - a, c - a)));
}
double quad_area(const std::array<Vec3, 4>& p) { return triangle_area(p[0], p[1], p[2]) + triangle_area(p[2], p[1], p[3]); }

// Where the rays through the picture's corners meet a plane through the origin.
std::array<Vec3, 4> corners_on_plane(const Camera& camera, IVec2 size, const Vec3& normal) {
  const View view(camera, size, PixelFilter(PixelFilter::Kind::centre));
  std::array<Vec3, 4> points;
  for (int corner = 0; corner < 4; ++corner) {
    Vec3 origin, direction;
    view.ray_through(corner & 1 ? static_cast<float>(size.x) : 0.f, corner & 2 ? static_cast<float>(size.y) : 0.f, Vec2(0.5f), origin,
                     direction);
    points[corner] = origin - direction * (glm::dot(origin, normal) / glm::dot(direction, normal));
  }
  return points;
}

const Vec3 kTilted{0, std::sin(kPi / 3), std::cos(kPi / 3)};

TEST(EyeAreas, OfAPlaneAddUpToWhatIsSeenOfIt) {
  for (const Vec3& normal : {Vec3{0, 0, 1}, kTilted, -kTilted}) {
    Scene scene;
    place(scene, square(Vec3(0), normal, 50));
    const auto world = build(scene);
    for (const bool orthographic : {false, true}) {
      Camera camera = camera_at({0, 0, 4}, Vec3(0), 0.6f);
      if (orthographic) camera.projection = Camera::Projection::orthographic, camera.ortho_height = 3;
      Take how;
      how.size_px = {45, 30};
      const double seen = quad_area(corners_on_plane(camera, how.size_px, normal));
      EXPECT_NEAR(total_area(take(*world, camera, how)), seen, 0.01 * seen);
      how.filter = PixelFilter::Kind::box, how.range = {0, 16}, how.pass_samples = 16;
      EXPECT_NEAR(total_area(take(*world, camera, how)), seen, 0.01 * seen);
      // A part of the pass has the density of the whole.
      how.range = {4, 8};
      EXPECT_NEAR(total_area(take(*world, camera, how)), seen / 4, 0.01 * seen / 4);
    }
  }
}

TEST(EyeAreas, AMirrorUnfolds) {
  Scene scene;
  const MaterialId mirror = add_material(scene, ConductorMaterial{});
  // Straight down onto the floor.
  place(scene, square(Vec3(0), glm::normalize(Vec3{0, -1, 1}), 2), mirror);
  place(scene, square({0, -3, 0}, {0, 1, 0}, 50));
  const Camera camera = camera_at({0, 0, 4}, Vec3(0), 0.4f);
  Take how;
  how.filter = PixelFilter::Kind::box, how.range = {0, 4}, how.pass_samples = 4;
  const double side = 2 * 7 * std::tan(0.2);
  EXPECT_NEAR(total_area(take(*build(scene), camera, how)), side * side, 0.01 * side * side);
}

TEST(EyeAreas, ALensAddsItsBlur) {
  Scene scene;
  place(scene, square(Vec3(0), {0, 0, 1}, 50));
  const auto world = build(scene);
  Camera camera = camera_at({0, 0, 4}, Vec3(0), 0.3f);
  camera.lens_radius = 0.1f;
  Take how;
  how.filter = PixelFilter::Kind::box, how.range = {0, 4}, how.pass_samples = 4;
  const double side = 2 * 4 * std::tan(0.15), samples = 64 * 64 * 4;
  for (const float focus : {2.f, 4.f, 1e6f}) {
    camera.focal_distance = focus;
    const double spot = 0.1 * (1 - 4 / static_cast<double>(focus));
    const double expected = side * side + samples * std::numbers::pi * spot * spot / 4;
    EXPECT_NEAR(total_area(take(*world, camera, how)), expected, 0.03 * expected) << focus;
  }
}

TEST(EyeAreas, GrazingAndFarOnesStayInBounds) {
  Scene scene;
  place(scene, square(Vec3(0), {0, 1, 0}, 1000));
  const auto world = build(scene);
  const float radius = world->bounds().half_diagonal();
  for (const Seen& seen : take(*world, camera_at({0, 0.01f, 0}, {1, 0, 0}, 1.5f), {}).seen) {
    EXPECT_GE(seen.eye.area, 1e-12f * radius * radius * 0.999f);
    EXPECT_LE(seen.eye.area, radius * radius * 1.001f);
  }
}

// Compares, over the picture, the areas that rays through neighbouring pixel centres span on the diffuse surface with the mean of their
// eye samples' areas. Of each pixel the branch that carries most counts.
void expect_areas_as_spanned(const World& world, const Camera& camera, double tolerance, std::size_t least_quads) {
  Take how;
  how.size_px = {128, 128};
  const Taken taken = take(world, camera, how);
  std::map<std::uint32_t, EyeSample> best;
  for (const Seen& seen : taken.seen) {
    const auto [at, fresh] = best.try_emplace(seen.pixel, seen.eye);
    if (!fresh && seen.eye.weight.x > at->second.weight.x) at->second = seen.eye;
  }
  double spanned = 0, claimed = 0;
  std::size_t quads = 0;
  for (std::uint32_t y = 0; y + 1 < 128; ++y) {
    for (std::uint32_t x = 0; x + 1 < 128; ++x) {
      std::array<Vec3, 4> corner;
      double mean = 0;
      bool complete = true;
      for (std::uint32_t k = 0; k < 4; ++k) {
        const auto found = best.find((y + k / 2) * 128 + x + k % 2);
        complete &= found != best.end();
        if (complete) corner[k] = found->second.position, mean += 0.25 * static_cast<double>(found->second.area);
      }
      if (!complete) continue;
      ++quads, spanned += quad_area(corner), claimed += mean;
    }
  }
  EXPECT_GE(quads, least_quads);
  EXPECT_NEAR(claimed, spanned, tolerance * spanned);
}

TEST(EyeAreas, AreWhatCurvedMirrorsSpan) {
  for (const bool tessellated : {false, true}) {
    SCOPED_TRACE(tessellated);
    Scene scene;
    const MaterialId mirror = add_material(scene, ConductorMaterial{});
    if (tessellated)
      place(scene, smooth_sphere(Vec3(0), 1, 48), mirror);
    else
      place_sphere(scene, Vec3(0), 1, mirror);
    place(scene, square({0, -2, 0}, {0, 1, 0}, 12));
    // The lower half of the ball fills the picture: the floor in it.
    expect_areas_as_spanned(*build(scene), camera_at({0, 0.5f, 5}, {0, -0.45f, 0.8f}, 0.16f), 0.02, 15000);
  }
}

TEST(EyeAreas, AreWhatAHollowMirrorSpans) {
  Scene scene;
  const MaterialId mirror = add_material(scene, ConductorMaterial{});
  place_sphere(scene, {0, 0, -2}, 8, mirror);
  place(scene, square({0, 0, 4.5f}, {0, 0, -1}, 5));
  // From within at the sphere's back; the light meets in a focus and goes on to the screen behind the camera.
  expect_areas_as_spanned(*build(scene), camera_at({0.5f, 0.3f, 4}, {0, 0, -10}, 0.2f), 0.02, 15000);
}

TEST(EyeAreas, AreWhatThickGlassSpans) {
  for (const int shape : {0, 1, 2}) {
    SCOPED_TRACE(shape);
    Scene scene;
    const MaterialId glass = add_material(scene, DielectricMaterial{});
    if (shape == 0) place(scene, box_mesh({-2, -2, -0.4f}, {2, 2, 0.4f}), glass);
    if (shape == 1) place_sphere(scene, Vec3(0), 1, glass);
    if (shape == 2) place(scene, smooth_sphere(Vec3(0), 1, 48), glass);
    place(scene, square({0, 0, -3}, {0, 0, 1}, 20));
    const Camera camera = shape == 0 ? camera_at({2, 1, 4}, Vec3(0), 0.3f) : camera_at({0, 0, 5}, Vec3(0), 0.22f);
    expect_areas_as_spanned(*build(scene), camera, 0.02, 15000);
  }
}

}  // namespace
}  // namespace sightline
