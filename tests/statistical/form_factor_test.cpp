// Light from polygons against Lambert's formula, pixel by pixel, and form factors between squares.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scene/builtin/parts.h"
#include "support/radiometry.h"
#include "support/studio.h"

namespace sightline::test {
namespace {

constexpr float kReflectance = 0.5f;

/// Looks straight down at the square [-1/2, 1/2]² of the plane y = 0 from just above it: pixels form a regular grid.
Camera looking_down() {
  Camera camera;
  camera.projection = Camera::Projection::orthographic;
  camera.ortho_height = 1;
  // Right = +x, up = -z, backwards = +y.
  camera.world_from_camera = Mat4(Vec4(1, 0, 0, 0), Vec4(0, 0, -1, 0), Vec4(0, 1, 0, 0), Vec4(0, 1e-3f, 0, 1));
  return camera;
}

Scene parallel(float distance) {
  Scene scene = builtin_scene("two-quads,reflectance=0.5,distance=" + std::to_string(distance));
  scene.cameras[0] = looking_down();
  return scene;
}

/// The emitter stands on the receiver's edge z = -1/2 and faces +z.
Scene perpendicular() {
  Scene scene;
  const float h = 0.5f;
  builtin::add_mesh(scene, builtin::MeshBuilder().quad({-h, 0, -h}, {0, 0, 1}, {1, 0, 0}).build("receiver"),
                    builtin::add_diffuse(scene, "receiver", Color(kReflectance)));
  builtin::add_mesh(scene, builtin::MeshBuilder().quad({-h, 0, -h}, {1, 0, 0}, {0, 1, 0}).build("emitter"),
                    builtin::add_emitter(scene, "emitter", Color(1)));
  scene.cameras.push_back(looking_down());
  return scene;
}

/// Mean radiance of the receiver over its reflectance: pixels filled evenly by a box filter, lights and BSDFs sampled.
double form_factor(const Scene& scene) {
  const Picture picture =
      expose(shot_of(scene, {32, 32}), {.spp = 2048, .light_samples = 1, .max_bounces = 0, .filter = PixelFilter::Kind::box});
  return picture.frame.mean_luminance() / kReflectance;
}

TEST(FormFactor, ParallelSquares) {
  for (const float distance : {0.2f, 0.5f, 1.f, 3.f}) {
    const double truth = parallel_squares(1, distance);
    EXPECT_NEAR(form_factor(parallel(distance)), truth, 1e-3 * truth) << distance;
  }
}

TEST(FormFactor, PerpendicularSquares) {
  const double truth = perpendicular_squares();
  EXPECT_NEAR(form_factor(perpendicular()), truth, 1e-3 * truth);
}

struct Deviation {
  double mean = 0, root_mean_square = 0, worst = 0;
};

/// One-hit mode in every pixel against the irradiance from a square above.
Deviation one_hit_deviation(const Scene& scene, double distance, int light_samples) {
  const Shot shot = shot_of(scene, {32, 32});
  const Picture picture = expose(shot, {.settings = {"mode=one-hit"}, .spp = 1, .light_samples = light_samples, .max_bounces = 0});
  const double h = 0.5, d = distance;
  const Vec3d corners[] = {{-h, d, -h}, {h, d, -h}, {h, d, h}, {-h, d, h}};
  Deviation deviation;
  for (std::uint32_t pixel = 0; pixel < 1024; ++pixel) {
    Vec3 origin, direction;
    centre_ray(shot, pixel, origin, direction);
    const double truth = polygon_irradiance({origin.x, 0, origin.z}, {0, 1, 0}, corners) / std::numbers::pi;
    const double relative = picture.frame.color(pixel).y / kReflectance / truth - 1;
    deviation.mean += relative / 1024;
    deviation.root_mean_square += relative * relative / 1024;
    deviation.worst = std::fmax(deviation.worst, std::fabs(relative));
  }
  deviation.root_mean_square = std::sqrt(deviation.root_mean_square);
  return deviation;
}

TEST(FormFactor, RectangleLightIsExactInEveryPixel) {
  for (const float distance : {0.5f, 1.f, 3.f}) {
    Scene scene = parallel(distance);
    scene.instances.pop_back();
    scene.lights.push_back(
        {.name = "light",
         .shape = RectangleLight{.center = {0, distance, 0}, .half_u = {0.5f, 0, 0}, .half_v = {0, 0, 0.5f}, .radiance = Color(1)},
         .node = {}});
    EXPECT_LE(one_hit_deviation(scene, distance, 1024).worst, 1e-3) << distance;
  }
}

TEST(FormFactor, GlowingMeshHasTheRightMeanInEveryPixel) {
  // Which of the two triangles, and where on it, are different dimensions: samples are stratified in each, not in both together, so that
  // pixels keep some noise.
  for (const float distance : {0.5f, 1.f, 3.f}) {
    const Deviation deviation = one_hit_deviation(parallel(distance), distance, 2048);
    EXPECT_LE(std::fabs(deviation.mean), 1e-3) << distance;
    EXPECT_LE(deviation.root_mean_square, 0.02) << distance;
  }
}

}  // namespace
}  // namespace sightline::test
