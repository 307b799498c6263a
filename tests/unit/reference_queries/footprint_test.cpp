// Areas that camera samples stand for add up to the surface that is seen.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "methods/eye_footprint.h"

namespace sightline::test {
namespace {

/// Sum over pixels of the footprints on the plane through `point` with `normal`, and that plane's area between the corner rays.
struct Sums {
  double areas = 0, truth = 0;
};
Sums sums_of(const Camera& camera, IVec2 size, float samples, const Vec3& point, const Vec3& normal) {
  const View view(camera, size, PixelFilter(PixelFilter::Kind::centre));
  const EyeFootprint footprint(view, samples);
  const auto hit = [&](float x, float y, Vec3& direction, float& distance) {
    Vec3 origin;
    view.ray_through(x, y, Vec2(0.5f), origin, direction);
    distance = glm::dot(point - origin, normal) / glm::dot(direction, normal);
    return Vec3d(origin) + static_cast<double>(distance) * Vec3d(direction);
  };
  Sums sums;
  Vec3 direction;
  float distance = 0;
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      hit(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, direction, distance);
      sums.areas += static_cast<double>(samples) * footprint.area(direction, distance, normal);
    }
  }
  const float w = static_cast<float>(size.x), h = static_cast<float>(size.y);
  const Vec3d a = hit(0, 0, direction, distance), b = hit(w, 0, direction, distance), c = hit(w, h, direction, distance),
              d = hit(0, h, direction, distance);
  sums.truth = 0.5 * glm::length(glm::cross(c - a, d - b));
  return sums;
}

Camera camera_of(Camera::Projection projection, float scale) {
  Camera camera;
  camera.projection = projection;
  camera.fov_rad = 0.8f;
  camera.ortho_height = 3;
  camera.world_from_camera = glm::scale(glm::inverse(glm::lookAt(Vec3(1, 2, 5), Vec3(0.5f, 0.2f, -1), Vec3(0.1f, 1, 0))), Vec3(scale));
  return camera;
}

TEST(EyeFootprint, AreasOfAllPixelsAddUpToThePlaneThatIsSeen) {
  for (const auto projection : {Camera::Projection::perspective, Camera::Projection::orthographic}) {
    for (const float scale : {1.f, 3.f}) {
      const Camera camera = camera_of(projection, scale);
      const Vec3 back = glm::normalize(Vec3(camera.world_from_camera[2])), up = glm::normalize(Vec3(camera.world_from_camera[1]));
      const Vec3 point = Vec3(camera.world_from_camera[3]) - 7.f * back;
      // Facing the camera, and tilted by 60 degrees.
      for (const Vec3& normal : {back, 0.5f * back + std::sqrt(0.75f) * up}) {
        const Sums sums = sums_of(camera, {96, 64}, 4, point, normal);
        EXPECT_NEAR(sums.areas, sums.truth, 0.01 * sums.truth) << static_cast<int>(projection) << " scale " << scale;
      }
    }
  }
}

TEST(EyeFootprint, ALensMakesItLargerOutOfFocusOnly) {
  Camera camera = camera_of(Camera::Projection::perspective, 1);
  const View sharp(camera, {64, 64}, PixelFilter());
  camera.lens_radius = 0.2f, camera.focal_distance = 7;
  const View lens(camera, {64, 64}, PixelFilter());
  const Vec3 axis = -glm::normalize(Vec3(camera.world_from_camera[2]));
  EXPECT_FLOAT_EQ(EyeFootprint(lens, 1).area(axis, 7, axis), EyeFootprint(sharp, 1).area(axis, 7, axis));
  EXPECT_NEAR(EyeFootprint(lens, 1).area(axis, 14, axis), EyeFootprint(sharp, 1).area(axis, 14, axis) + kPi * 0.04f, 1e-4);
}

}  // namespace
}  // namespace sightline::test
