#include "film/view.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/core/aligned.h"

namespace sightline {
namespace {

Camera simple_camera() {
  Camera camera;
  camera.fov_rad = kPi / 2;
  return camera;
}

TEST(View, CentreLooksAlongMinusZAndEdgesSpanTheFieldOfView) {
  const View view(simple_camera(), {200, 100}, PixelFilter(PixelFilter::Kind::centre));
  Vec3 origin, direction;
  view.ray_through(100, 50, Vec2(0.5f), origin, direction);
  EXPECT_NEAR(glm::length(direction - Vec3(0, 0, -1)), 0, 1e-6f);
  view.ray_through(100, 0, Vec2(0.5f), origin, direction);  // the top edge, half the vertical field of view up
  EXPECT_NEAR(std::atan2(direction.y, -direction.z), kPi / 4, 1e-6f);
  view.ray_through(200, 50, Vec2(0.5f), origin, direction);  // the right edge: twice as wide as high
  EXPECT_NEAR(direction.x / -direction.z, 2, 1e-5f);
}

TEST(View, FieldOfViewOfTheShorterSide) {
  Camera camera = simple_camera();
  camera.fov_axis = Camera::FovAxis::shorter;
  const View view(camera, {100, 200}, PixelFilter());
  Vec3 origin, direction;
  view.ray_through(100, 100, Vec2(0.5f), origin, direction);
  EXPECT_NEAR(direction.x / -direction.z, 1, 1e-5f);
}

TEST(View, OrthographicRaysAreParallel) {
  Camera camera;
  camera.projection = Camera::Projection::orthographic;
  camera.ortho_height = 4;
  const View view(camera, {100, 100}, PixelFilter());
  Vec3 origin, direction;
  view.ray_through(0, 0, Vec2(0.5f), origin, direction);
  EXPECT_NEAR(glm::length(origin - Vec3(-2, 2, 0)), 0, 1e-6f);
  EXPECT_EQ(direction, Vec3(0, 0, -1));
}

TEST(View, LensRaysMeetInTheFocalPlane) {
  Camera camera = simple_camera();
  camera.lens_radius = 0.3f;
  camera.focal_distance = 5;
  const View view(camera, {100, 100}, PixelFilter());
  Vec3 origin, direction;
  for (const Vec2 lens : {Vec2(0.1f, 0.9f), Vec2(0.5f, 0.2f), Vec2(0.99f, 0.6f)}) {
    view.ray_through(80, 30, lens, origin, direction);
    EXPECT_LE(glm::length(origin), 0.3001f);
    const Vec3 focus = origin + direction * ((-5 - origin.z) / direction.z);
    EXPECT_NEAR(focus.x, 5 * 0.6f, 1e-4f);
    EXPECT_NEAR(focus.y, 5 * 0.4f, 1e-4f);
  }
}

TEST(View, BatchEqualsTheScalarDefinition) {
  constexpr std::size_t kCount = 333;
  for (const float lens : {0.f, 0.1f}) {
    Camera camera = simple_camera();
    camera.lens_radius = lens;
    camera.focal_distance = 3;
    const View view(camera, {37, 21}, PixelFilter());
    AlignedVector<std::uint32_t> pixels(padded(kCount));
    AlignedVector<float> a(padded(kCount)), b(padded(kCount)), c(padded(kCount)), d(padded(kCount));
    Vec3Batch origins, directions;
    origins.resize(kCount), directions.resize(kCount);
    for (std::size_t i = 0; i < kCount; ++i) {
      pixels[i] = static_cast<std::uint32_t>((i * 7) % (37 * 21));
      a[i] = static_cast<float>((i * 37 % 101)) / 101, b[i] = static_cast<float>((i * 53 % 97)) / 97;
      c[i] = static_cast<float>((i * 11 % 89)) / 89, d[i] = static_cast<float>((i * 19 % 83)) / 83;
    }
    view.primary_rays(
        pixels.data(), a.data(), b.data(), c.data(), d.data(), kCount,
        {origins.x.data(), origins.y.data(), origins.z.data(), directions.x.data(), directions.y.data(), directions.z.data()});
    for (std::size_t i = 0; i < kCount; ++i) {
      Vec3 origin, direction;
      view.ray_through(static_cast<float>(pixels[i] % 37) + 0.5f + view.filter().offset(a[i]),
                       static_cast<float>(pixels[i] / 37) + 0.5f + view.filter().offset(b[i]), {c[i], d[i]}, origin, direction);
      EXPECT_NEAR(glm::length(origin - Vec3(origins.x[i], origins.y[i], origins.z[i])), 0, 1e-6f);
      EXPECT_NEAR(glm::length(direction - Vec3(directions.x[i], directions.y[i], directions.z[i])), 0, 2e-6f);
    }
  }
}

TEST(PixelFilter, GaussianHasItsMomentsAndSupport) {
  const PixelFilter filter(PixelFilter::Kind::gaussian);
  double mean = 0, square = 0;
  constexpr int kCount = 100000;
  for (int i = 0; i < kCount; ++i) {
    const double x = filter.offset((static_cast<float>(i) + 0.5f) / kCount);
    EXPECT_LE(std::abs(x), 1.5 + 1e-6);
    mean += x, square += x * x;
  }
  // Variance of a Gaussian of sigma 0.5 cut at 3 sigma: 0.25 (1 - 2·3·phi(3) / (2 Phi(3) - 1)) = 0.24333.
  EXPECT_NEAR(mean / kCount, 0, 1e-5);
  EXPECT_NEAR(square / kCount, 0.24333, 2e-4);
  EXPECT_NEAR(filter.offset(0.5f), 0, 1e-7f);
}

TEST(View, MirroredCameraMirrorsThePicture) {
  Camera camera = simple_camera();
  Camera mirrored = camera;
  mirrored.world_from_camera[0] *= -1.f;
  const View a(camera, {64, 64}, PixelFilter()), b(mirrored, {64, 64}, PixelFilter());
  Vec3 origin, left, right;
  a.ray_through(10, 20, Vec2(0.5f), origin, left);
  b.ray_through(10, 20, Vec2(0.5f), origin, right);
  EXPECT_NEAR(left.x, -right.x, 1e-6f);
  EXPECT_NEAR(left.y, right.y, 1e-6f);
}

}  // namespace
}  // namespace sightline
