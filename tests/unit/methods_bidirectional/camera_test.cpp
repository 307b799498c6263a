// The camera seen from the scene is the camera that sends out rays.
#include "methods/bidirectional/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/chi_square.h"

namespace sightline::bidirectional {
namespace {

std::vector<Camera> cameras() {
  Camera plain;
  plain.fov_rad = 0.8f;
  plain.world_from_camera[3] = Vec4(1, 2, 3, 1);
  Camera turned = plain;
  const Vec3 z = glm::normalize(Vec3(1, 2, 0.5f)), x = glm::normalize(glm::cross(Vec3(0, 1, 0), z)), y = glm::cross(z, x);
  turned.world_from_camera = Mat4(Vec4(x, 0), Vec4(y, 0), Vec4(z, 0), Vec4(-1, 0.5f, 2, 1));
  Camera mirrored = turned;
  mirrored.world_from_camera[0] = -mirrored.world_from_camera[0];
  Camera lens = turned;
  lens.lens_radius = 0.3f, lens.focal_distance = 4;
  Camera window = plain;
  window.screen_window = Vec4(-0.2f, -0.9f, 0.7f, 0.4f);
  Camera orthographic = turned;
  orthographic.projection = Camera::Projection::orthographic;
  orthographic.ortho_height = 3;
  return {plain, turned, mirrored, lens, window, orthographic};
}

TEST(BidirectionalCamera, PointsAppearWhereTheirRaysPassTheFilm) {
  for (const Camera& c : cameras()) {
    const View view(c, {40, 30}, PixelFilter());
    const CameraImportance camera(view);
    test::Uniform u(1);
    for (int i = 0; i < 1000; ++i) {
      const Vec2 film{40 * u.next(), 30 * u.next()}, on_lens = u.next2();
      Vec3 origin, direction;
      view.ray_through(film.x, film.y, on_lens, origin, direction);
      const float distance = 0.5f + 5 * u.next();
      const auto seen = camera.project(camera.lens_point(on_lens), origin + distance * direction);
      ASSERT_TRUE(seen);
      EXPECT_NEAR(seen->film.x, film.x, 2e-3f);
      EXPECT_NEAR(seen->film.y, film.y, 2e-3f);
      EXPECT_NEAR(seen->distance, distance, 1e-4f);
      EXPECT_NEAR(glm::dot(seen->direction, direction), 1, 1e-5f);
      EXPECT_NEAR(seen->pdf / camera.pdf(origin, direction), 1, 1e-4);
      EXPECT_FALSE(camera.project(camera.lens_point(on_lens), origin - distance * direction));
    }
  }
}

TEST(BidirectionalCamera, DensityIsThatOfRaysThroughTheFilm) {
  // One pixel's share of the film, by the solid angle (or the area) that it covers.
  for (const Camera& c : cameras()) {
    const View view(c, {40, 30}, PixelFilter());
    const CameraImportance camera(view);
    test::Uniform u(2);
    for (int i = 0; i < 200; ++i) {
      const Vec2 film{40 * u.next(), 30 * u.next()}, on_lens = u.next2();
      constexpr float kStep = 0.05f;
      const auto ray = [&](float dx, float dy, Vec3& origin) {
        Vec3 direction;
        view.ray_through(film.x + dx * kStep, film.y + dy * kStep, on_lens, origin, direction);
        return direction;
      };
      Vec3 o, ox, oy, ignored;
      const Vec3 d = ray(0, 0, o), right = ray(1, 0, ox), left = ray(-1, 0, ignored), up = ray(0, 1, oy);
      const Vec3 down = ray(0, -1, ignored);
      const double covered = camera.is_orthographic() ? static_cast<double>(glm::length(glm::cross(ox - o, oy - o)))
                                                      : glm::length(glm::cross(Vec3d(right - left), Vec3d(up - down))) / 4;
      EXPECT_NEAR(camera.pdf(o, d) * covered, kStep * kStep / (40 * 30), 0.01 * kStep * kStep / (40 * 30));
    }
  }
}

TEST(BidirectionalCamera, SharesAreTheDensityOfTheFilter) {
  for (const auto kind : {PixelFilter::Kind::gaussian, PixelFilter::Kind::box}) {
    const PixelFilter filter(kind);
    const CameraImportance camera(View(Camera(), {7, 5}, filter));
    // Of each pixel that a film position lies in, the share is the probability per area with which its samples fall there.
    const std::uint32_t pixel = 2 * 7 + 3;
    const int cells = 12;
    std::vector<double> expected, counted(static_cast<std::size_t>(cells * cells), 0);
    const auto cell_of = [&](float offset) { return static_cast<int>(std::floor((offset + 1.5f) / 3 * static_cast<float>(cells))); };
    std::array<CameraImportance::Share, CameraImportance::kMaxShares> shares;
    constexpr int kSamples = 200000, kFine = 40;
    for (int y = 0; y < cells; ++y) {
      for (int x = 0; x < cells; ++x) {
        double sum = 0;
        for (int i = 0; i < kFine * kFine; ++i) {
          const double fx = (x + (i % kFine + 0.5) / kFine) * 3.0 / cells - 1.5;
          const double fy = (y + (i / kFine + 0.5) / kFine) * 3.0 / cells - 1.5;  // NOLINT(bugprone-integer-division): the row
          const int n = camera.shares({3.5f + static_cast<float>(fx), 2.5f + static_cast<float>(fy)}, shares.data());
          for (int k = 0; k < n; ++k)
            sum += shares[static_cast<std::size_t>(k)].pixel == pixel ? shares[static_cast<std::size_t>(k)].weight : 0;
        }
        expected.push_back(kSamples * sum / (kFine * kFine) * 9.0 / (cells * cells));
      }
    }
    test::Uniform u(3);
    for (int i = 0; i < kSamples; ++i) {
      const int x = cell_of(filter.offset(u.next())), y = cell_of(filter.offset(u.next()));
      ++counted[static_cast<std::size_t>(std::clamp(y, 0, cells - 1) * cells + std::clamp(x, 0, cells - 1))];
    }
    const test::ChiSquareResult result = test::chi_square(counted, expected);
    EXPECT_GT(result.p_value, 1e-4) << result.table;
  }
}

TEST(BidirectionalCamera, PixelCentresCannotBeHit) {
  EXPECT_FALSE(CameraImportance(View(Camera(), {4, 4}, PixelFilter(PixelFilter::Kind::centre))).has_light_image());
  EXPECT_TRUE(CameraImportance(View(Camera(), {4, 4}, PixelFilter(PixelFilter::Kind::box))).has_light_image());
}

}  // namespace
}  // namespace sightline::bidirectional
