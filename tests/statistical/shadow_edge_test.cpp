// The shadow of a straight edge: hard from a point or from afar, a known penumbra from a square.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/radiometry.h"
#include "support/studio.h"

namespace sightline::test {
namespace {

constexpr double kFloorReflectance = 0.7;

/// A strip of the floor from x = -range to range at z = 0, seen from between floor and plate: one pixel row.
Shot strip(const std::string& spec, float range, int pixels) {
  Scene scene = builtin_scene(spec);
  Camera& camera = scene.cameras[0];
  camera = {};
  camera.projection = Camera::Projection::orthographic;
  camera.ortho_height = 2 * range / static_cast<float>(pixels);
  camera.world_from_camera = Mat4(Vec4(1, 0, 0, 0), Vec4(0, 0, -1, 0), Vec4(0, 1, 0, 0), Vec4(0, 0.1f, 0, 1));
  return shot_of(std::move(scene), {pixels, 1});
}

float floor_x(const Shot& shot, std::uint32_t pixel) {
  Vec3 origin, direction;
  centre_ray(shot, pixel, origin, direction);
  return origin.x;
}

TEST(ShadowEdge, PenumbraOfASquareIsTheVisiblePartOfIt) {
  for (const double size : {0.2, 0.5, 1.0}) {
    const Shot shot = strip("half-plane,light=area,light_size=" + std::to_string(size), static_cast<float>(size), 256);
    const Picture picture = expose(shot, {.settings = {"mode=one-hit"}, .spp = 1, .light_samples = 4096, .max_bounces = 0});
    const double h = size / 2, radiance = 10 / (size * size);
    const Vec3d whole_light[] = {{-h, 2, -h}, {h, 2, -h}, {h, 2, h}, {-h, 2, h}};
    int dark = 0, full = 0;
    for (std::uint32_t pixel = 0; pixel < 256; ++pixel) {
      const double x = floor_x(shot, pixel);
      const double from = std::clamp(-x, -h, h);  // the plate's edge hides what lies left of -x
      const Vec3d visible[] = {{from, 2, -h}, {h, 2, -h}, {h, 2, h}, {from, 2, h}};
      const Vec3d point(x, 0, 0), normal(0, 1, 0);
      const double scale = kFloorReflectance / std::numbers::pi * radiance;
      const double truth = scale * polygon_irradiance(point, normal, visible);
      const double whole = scale * polygon_irradiance(point, normal, whole_light);
      const double seen = picture.frame.color(pixel).y;
      // 4096 stratified samples miss an edge across them by the perimeter of their cells: about 1 / 64 of a cell row at worst.
      EXPECT_NEAR(seen, truth, 2e-3 * whole) << "x " << x;
      if (x < -h) {
        ++dark;
        EXPECT_EQ(seen, 0) << "x " << x;
      }
      if (x > h) {
        ++full;
        EXPECT_NEAR(seen, truth, 5e-4 * truth) << "x " << x;
      }
    }
    EXPECT_GE(dark, 60);
    EXPECT_GE(full, 60);
  }
}

TEST(ShadowEdge, PointAndDirectionalLightsHaveHardEdges) {
  for (const char* light : {"point", "directional"}) {
    const bool point = std::string_view(light) == "point";
    // Pixels down to 4e-5 from the edge.
    const Shot shot = strip("half-plane,light=" + std::string(light), 0.01f, 256);
    const Picture picture = expose(shot, {.settings = {"mode=one-hit"}, .spp = 1, .light_samples = 1, .max_bounces = 0});
    for (std::uint32_t pixel = 0; pixel < 256; ++pixel) {
      const double x = floor_x(shot, pixel), square = 4 + x * x;
      const double irradiance = point ? 10 * (2 / std::sqrt(square)) / square : 3;
      const double truth = x > 0 ? kFloorReflectance / std::numbers::pi * irradiance : 0;
      EXPECT_NEAR(picture.frame.color(pixel).y, truth, 1e-5 * truth) << light << " x " << x;
    }
  }
}

}  // namespace
}  // namespace sightline::test
