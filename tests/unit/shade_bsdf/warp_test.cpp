#include "base/sample/warp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "bsdf_cases.h"
#include "support/chi_square.h"

namespace sightline::test {
namespace {

constexpr int kSamples = 50000;
constexpr double kSignificance = 1e-3;

std::size_t cell_index(int row, int column, int columns) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
}

template <class Sample, class Pdf>
void expect_directions_follow(const char* what, const Sample& sample, const Pdf& pdf, const DirectionGrid& grid = {}) {
  Uniform random(42);
  const auto result = chi_square_directions([&] { return std::optional<Vec3>(sample(random.next2())); },
                                            [&](const Vec3& w) { return static_cast<double>(pdf(w)); }, grid, kSamples);
  EXPECT_GE(result.p_value, kSignificance) << what << "\n" << result.table;
}

template <class Warp, class Inverse>
void expect_inverse(const char* what, const Warp& warp, const Inverse& inverse, float tolerance = 2e-4f) {
  Uniform random(43);
  for (int i = 0; i < 2000; ++i) {
    // Away from the seams of the azimuth and from points that all of an edge maps to.
    const Vec2 u = 0.02f + 0.96f * random.next2();
    const Vec2 back = inverse(warp(u));
    EXPECT_LT(glm::length(back - u), tolerance) << what << ": (" << u.x << ", " << u.y << ") became (" << back.x << ", " << back.y << ")";
  }
}

TEST(Warp, ConcentricDiskIsUniform) {
  constexpr int kRings = 16, kSectors = 16;
  std::vector<double> observed(kRings * kSectors, 0), expected(observed.size(), 0);
  Uniform random(1);
  for (int i = 0; i < kSamples; ++i) {
    const Vec2 p = sample_concentric_disk(random.next2());
    const float radius2 = std::min(glm::dot(p, p), kOneMinusEpsilon);  // equal steps of r² are equal areas
    ASSERT_LE(glm::dot(p, p), 1 + 1e-6f);
    observed[cell_index(static_cast<int>(radius2 * kRings), static_cast<int>(azimuth_turn(p.x, p.y) * kSectors), kSectors)] += 1;
  }
  for (double& e : expected) e = kSamples * static_cast<double>(pdf_concentric_disk()) * std::numbers::pi / (kRings * kSectors);
  const auto result = chi_square(observed, expected);
  EXPECT_GE(result.p_value, kSignificance) << result.table;
  expect_inverse("disk", sample_concentric_disk, invert_concentric_disk);
  EXPECT_EQ(sample_concentric_disk(Vec2(0.5f)), Vec2(0));
}

TEST(Warp, TriangleIsUniform) {
  constexpr int kSteps = 12;  // cells: upright and inverted triangles of equal area
  std::vector<double> observed(kSteps * kSteps * 2, 0), expected(observed.size(), 0);
  Uniform random(2);
  for (int i = 0; i < kSamples; ++i) {
    const Vec2 b = sample_uniform_triangle(random.next2());
    ASSERT_GE(b.x, 0);
    ASSERT_GE(b.y, 0);
    ASSERT_LE(b.x + b.y, 1 + 1e-6f);
    const int x = std::min(static_cast<int>(b.x * kSteps), kSteps - 1), y = std::min(static_cast<int>(b.y * kSteps), kSteps - 1);
    const bool inverted = b.x * kSteps - static_cast<float>(x) + b.y * kSteps - static_cast<float>(y) > 1;
    observed[cell_index(x * kSteps + y, inverted ? 1 : 0, 2)] += 1;
  }
  for (int x = 0; x < kSteps; ++x)
    for (int y = 0; x + y < kSteps; ++y)
      for (const bool inverted : {false, true})
        if (!inverted || x + y < kSteps - 1)
          expected[cell_index(x * kSteps + y, inverted ? 1 : 0, 2)] =
              kSamples * static_cast<double>(pdf_uniform_triangle()) / (2.0 * kSteps * kSteps);
  // A point within rounding of the long edge may fall into a cell that lies beyond it.
  for (std::size_t i = 0; i < expected.size(); ++i)
    if (expected[i] == 0 && observed[i] <= 1) observed[i] = 0;
  const auto result = chi_square(observed, expected);
  EXPECT_GE(result.p_value, kSignificance) << result.table;
  expect_inverse("triangle", sample_uniform_triangle, invert_uniform_triangle);
}

TEST(Warp, CosineHemisphere) {
  expect_directions_follow("cosine", sample_cosine_hemisphere, [](const Vec3& w) { return pdf_cosine_hemisphere(w.z); });
  expect_inverse("cosine", sample_cosine_hemisphere, invert_cosine_hemisphere);
}

TEST(Warp, UniformHemisphereAndSphere) {
  expect_directions_follow("hemisphere", sample_uniform_hemisphere, [](const Vec3& w) { return w.z > 0 ? pdf_uniform_hemisphere() : 0.f; });
  expect_inverse("hemisphere", sample_uniform_hemisphere, invert_uniform_hemisphere);
  expect_directions_follow("sphere", sample_uniform_sphere, [](const Vec3&) { return pdf_uniform_sphere(); });
  expect_inverse("sphere", sample_uniform_sphere, invert_uniform_sphere);
}

TEST(Warp, Cone) {
  const float half = 0.3f;  // 1 - cos
  expect_directions_follow(
      "cone", [=](const Vec2& u) { return sample_uniform_cone(u, half); },
      [=](const Vec3& w) { return 1 - w.z < half ? pdf_uniform_cone(half) : 0.f; }, {Vec3(0, 0, 1), 1, 40, 16});
  for (const float narrow : {2.f, 0.3f, 1e-4f, 1e-9f})
    expect_inverse(
        "cone", [=](const Vec2& u) { return sample_uniform_cone(u, narrow); },
        [=](const Vec3& w) { return invert_uniform_cone(w, narrow); });
}

TEST(Warp, PhongLobe) {
  for (const float exponent : {0.f, 1.f, 20.f, 1000.f}) {
    expect_directions_follow(
        "phong", [=](const Vec2& u) { return sample_phong_lobe(u, exponent); },
        [=](const Vec3& w) { return pdf_phong_lobe(w.z, exponent); }, {Vec3(0, 0, 1), exponent > 10 ? 3.f : 1.f, 24, 12});
    expect_inverse(
        "phong", [=](const Vec2& u) { return sample_phong_lobe(u, exponent); },
        [=](const Vec3& w) { return invert_phong_lobe(w, exponent); }, exponent > 100 ? 5e-3f : 5e-4f);
  }
}

TEST(Warp, GgxVisibleNormals) {
  for (const Vec2 alpha : {Vec2(1, 1), Vec2(0.5f, 0.5f), Vec2(0.6f, 0.15f), Vec2(0.05f, 0.05f)}) {
    for (const Vec3& wo : {Vec3(0, 0, 1), direction_at(0.6f, 1), direction_at(0.1f, 3), direction_at(0.01f, 5)}) {
      expect_directions_follow(
          "ggx", [&](const Vec2& u) { return sample_ggx_visible_normal(wo, alpha, u); },
          [&](const Vec3& m) { return pdf_ggx_visible_normal(wo, alpha, m); }, {Vec3(0, 0, 1), alpha.y < 0.2f ? 2.5f : 1.f, 24, 16});
      expect_inverse(
          "ggx", [&](const Vec2& u) { return sample_ggx_visible_normal(wo, alpha, u); },
          [&](const Vec3& m) { return invert_ggx_visible_normal(wo, alpha, m); }, 5e-3f);
    }
  }
}

TEST(Warp, GgxVisibleNormalsAreProjectedOntoOneUnitOfArea) {
  // What is visible from wo adds up to the cosine of wo: the density integrates to 1 (Smith's masking was derived from this).
  for (const float alpha : {0.1f, 0.5f, 1.f}) {
    for (const float cosine : {1.f, 0.5f, 0.05f}) {
      const Vec3 wo = direction_at(cosine, 0);
      double sum = 0;
      constexpr int kSteps = 1000, kTurns = 250;
      for (int i = 0; i < kSteps; ++i) {
        for (int j = 0; j < kTurns; ++j) {
          // Slopes r cos(phi), r sin(phi), r = alpha s / (1 - s).
          const double s = (i + 0.5) / kSteps, phi = 2 * std::numbers::pi * (j + 0.5) / kTurns;
          const double r = alpha * s / (1 - s), dr = alpha / ((1 - s) * (1 - s)) / kSteps;
          const double z = 1 / std::sqrt(1 + r * r);
          const Vec3 m(static_cast<float>(r * z * std::cos(phi)), static_cast<float>(r * z * std::sin(phi)), static_cast<float>(z));
          const double solid_angle = r * z * z * z * dr * 2 * std::numbers::pi / kTurns;
          sum += pdf_ggx_visible_normal(wo, Vec2(alpha), m) * solid_angle;
        }
      }
      EXPECT_NEAR(sum, 1, 2e-3) << alpha << " " << cosine;
    }
  }
}

}  // namespace
}  // namespace sightline::test
