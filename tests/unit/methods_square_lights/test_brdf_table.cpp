#include "methods/square_lights/brdf_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "base/core/error.h"
#include "methods/square_lights/hemisphere_disk.h"

namespace sightline::square_lights {
namespace {

constexpr float kCell = 2.f / BrdfTable::kCells;
/// Half diagonal on the disk of a square that covers one cell.
const float kCellRadius = kCell / std::sqrt(2.f);

Vec2 cell_center(int x, int y) { return {-1 + kCell * (static_cast<float>(x) + 0.5f), -1 + kCell * (static_cast<float>(y) + 0.5f)}; }

/// The view of an isotropic table's slice whose azimuth on the disk is 0.
Vec3 slice_view(int k) {
  const float angle = kPi / 2 * static_cast<float>(k) / (BrdfTable::kViews - 1);
  return {0, std::sin(angle), std::cos(angle)};
}

Bsdf metal(float alpha_u, float alpha_v) {
  return Bsdf(Conductor(Color(0.2f, 0.9f, 1.1f), Color(3.9f, 2.4f, 2.2f), Color(1), Ggx(alpha_u, alpha_v)));
}

double brute_mean(const Bsdf& bsdf, const Vec3& wo, const Vec2& center, float edge, int points) {
  double sum = 0;
  for (int j = 0; j < points; ++j) {
    for (int i = 0; i < points; ++i) {
      const Vec2 p = center + edge * Vec2((static_cast<float>(i) + 0.5f) / static_cast<float>(points) - 0.5f,
                                          (static_cast<float>(j) + 0.5f) / static_cast<float>(points) - 0.5f);
      if (glm::dot(p, p) < 1) sum += bsdf.evaluate(wo, direction_from_disk(p)).f_cos.y;
    }
  }
  return sum / (points * points);
}

/// f cos over the whole hemisphere: twice the integral over the disk.
double albedo(const BrdfTable& table, const Vec3& wo) {
  const float r_p = std::sqrt(2.f);
  return 2.0 * 2 * r_p * r_p * table.mean(table.slices(wo), Vec2(0), r_p).y;
}

TEST(BrdfTable, WhiteLambertReflectsEverything) {
  const Context context;
  const BrdfTable table = BrdfTable::build(Bsdf(Lambert{Color(1)}), 4, context);
  EXPECT_TRUE(table.isotropic());
  for (const float cosine : {1.f, 0.7f, 0.2f, 0.02f}) EXPECT_NEAR(albedo(table, {std::sqrt(1 - cosine * cosine), 0, cosine}), 1, 2e-3);
}

TEST(BrdfTable, SquaresAreSumsOverCells) {
  const Context context;
  const BrdfTable table = BrdfTable::build(metal(0.3f, 0.3f), 4, context);
  const BrdfTable::Slices slices = table.slices(slice_view(11));
  std::array<double, 1024> cells;
  double greatest = 0;
  for (int i = 0; i < 1024; ++i) {
    cells[static_cast<std::size_t>(i)] = table.mean(slices, cell_center(i % 32, i / 32), kCellRadius).y;
    greatest = std::max(greatest, cells[static_cast<std::size_t>(i)]);
  }
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (int trial = 0; trial < 500; ++trial) {
    const Vec2 p{unit(random), unit(random)};
    const float half = 0.04f + 0.5f * std::fabs(unit(random)), r_p = half * std::sqrt(2.f);
    double sum = 0;
    for (int i = 0; i < 1024; ++i) {
      const Vec2 c = cell_center(i % 32, i / 32);
      const auto overlap = [&](float center, float at) {
        return std::max(0.f, std::min(center + kCell / 2, at + half) - std::max(center - kCell / 2, at - half));
      };
      sum += cells[static_cast<std::size_t>(i)] * overlap(c.x, p.x) * overlap(c.y, p.y);
    }
    // What lies beyond the table counts as nothing, but the square keeps its full area.
    EXPECT_NEAR(table.mean(slices, p, r_p).y * 2 * r_p * r_p, sum, 1e-5 * greatest + 1e-5 * sum);
  }
}

TEST(BrdfTable, CellsAreMeansHoweverNarrowTheLobe) {
  const Context context;
  const std::vector<Bsdf> bsdfs{Bsdf(Phong(Color(0.1f), Color(0.6f), 20)),
                                Bsdf(Phong(Color(0.1f), Color(0.6f), 3000)),
                                Bsdf(Phong(Color(0.1f), Color(0.6f), 30000)),
                                metal(0.3f, 0.3f),
                                metal(0.02f, 0.02f),
                                Bsdf(CoatedDiffuse(Color(0.5f), 1.5f, Ggx(0.1f, 0.1f)))};
  for (std::size_t k = 0; k < bsdfs.size(); ++k) {
    const BrdfTable table = BrdfTable::build(bsdfs[k], 8, context);
    for (const int view : {3, 20}) {
      const Vec3 wo = slice_view(view);
      const BrdfTable::Slices slices = table.slices(wo);
      double error = 0, sum = 0;
      for (int i = 0; i < 1024; ++i) {
        const Vec2 center = cell_center(i % 32, i / 32);
        if (glm::dot(center, center) > 1.1f) continue;
        const double truth = brute_mean(bsdfs[k], wo, center, kCell, 24), value = table.mean(slices, center, kCellRadius).y;
        error += std::fabs(value - truth), sum += truth;
      }
      EXPECT_LT(error / sum, 5e-3) << "bsdf " << k << " view " << view;
    }
  }
}

TEST(BrdfTable, KeepsTheEnergyOfTheBsdf) {
  const Context context;
  for (const Bsdf& bsdf : {metal(0.15f, 0.15f), metal(0.01f, 0.01f), metal(0.05f, 0.4f)}) {
    const BrdfTable table = BrdfTable::build(bsdf, 4, context);
    for (const float cosine : {0.95f, 0.6f}) {
      const Vec3 wo{0.8f * std::sqrt(1 - cosine * cosine), 0.6f * std::sqrt(1 - cosine * cosine), cosine};
      double sum = 0;
      constexpr int kSamples = 40000;
      for (int i = 0; i < kSamples; ++i) {
        const auto sample =
            bsdf.sample(wo, 0.5f, {(static_cast<float>(i) + 0.5f) / kSamples, std::fmod(static_cast<float>(i) * 0.61803399f, 1.f)});
        if (sample && sample->wi.z > 0) sum += sample->weight.y / kSamples;
      }
      // Between two tabulated views lobes are blended, not moved: energy is kept but where it changes fast.
      EXPECT_NEAR(albedo(table, wo) / sum, 1, 0.015) << "cosine " << cosine;
    }
  }
}

TEST(BrdfTable, IsotropicTablesTurnWithTheView) {
  const Context context;
  const BrdfTable table = BrdfTable::build(metal(0.2f, 0.2f), 4, context);
  const Vec3 wo = slice_view(14);
  const Vec3 wi = glm::normalize(Vec3(0.2f, -0.5f, 0.6f));
  const Color here = table.mean(table.slices(wo), disk_from_direction(wi), 0.02f);
  EXPECT_NEAR(here.y / metal(0.2f, 0.2f).evaluate(wo, wi).f_cos.y, 1, 0.1f);
  for (const float angle : {0.3f, 1.f, 2.f, 4.f}) {
    const auto turned = [c = std::cos(angle), s = std::sin(angle)](const Vec3& w) {
      return Vec3(c * w.x - s * w.y, s * w.x + c * w.y, w.z);
    };
    const Color there = table.mean(table.slices(turned(wo)), disk_from_direction(turned(wi)), 0.02f);
    // The square itself does not turn, so that cells are cut in other ways; it is small against them.
    EXPECT_NEAR(there.y / here.y, 1, 1e-4f) << "angle " << angle;
  }
}

TEST(BrdfTable, AnisotropicViewsOfAllQuadrantsAgreeWithTheBsdf) {
  const Context context;
  const Bsdf bsdf = metal(0.6f, 0.25f);
  const BrdfTable table = BrdfTable::build(bsdf, 4, context);
  EXPECT_FALSE(table.isotropic());
  std::mt19937 random(9);
  std::uniform_int_distribution<int> cell(0, 31);
  for (int trial = 0; trial < 300; ++trial) {
    const Vec2 view = cell_center(cell(random), cell(random)), light = cell_center(cell(random), cell(random));
    if (glm::dot(view, view) > 0.9f || glm::dot(light, light) > 0.9f) continue;
    const Vec3 wo = direction_from_disk(view);
    const float value = table.mean(table.slices(wo), light, kCellRadius).y;
    EXPECT_NEAR(value, brute_mean(bsdf, wo, light, kCell, 12), 0.01 * value + 1e-4);
  }
  // Between the views that were tabulated.
  const Vec3 wo = glm::normalize(Vec3(0.31f, -0.4f, 0.8f)), wi = glm::normalize(Vec3(-0.2f, 0.3f, 0.7f));
  EXPECT_NEAR(table.mean(table.slices(wo), disk_from_direction(wi), 0.02f).y / bsdf.evaluate(wo, wi).f_cos.y, 1, 0.05f);
}

TEST(BrdfTable, SlicesWeighOneAndLightFromBelowIsNothing) {
  const Context context;
  for (const Bsdf& bsdf : {metal(0.3f, 0.3f), metal(0.3f, 0.5f)}) {
    const BrdfTable table = BrdfTable::build(bsdf, 1, context);
    std::mt19937 random(4);
    std::uniform_real_distribution<float> unit(-1, 1);
    for (int i = 0; i < 200; ++i) {
      const Vec3 wo = glm::normalize(Vec3(unit(random), unit(random), std::fabs(unit(random))));
      const BrdfTable::Slices slices = table.slices(wo);
      float sum = 0;
      for (int k = 0; k < slices.count; ++k) sum += slices.weight[k];
      EXPECT_NEAR(sum, 1, 1e-5f);
      EXPECT_NEAR(glm::length(slices.turn), 1, 1e-5f);
      const Vec2 below = disk_from_direction(glm::normalize(Vec3(unit(random), unit(random), -0.3f)));
      EXPECT_LT(table.mean(slices, below, 0.03f).y, 2e-5f);  // rounding of sums, by the area
    }
  }
}

TEST(BrdfTable, MomentsAreThoseOfTheCells) {
  const Context context;
  const BrdfTable table = BrdfTable::build(metal(0.2f, 0.2f), 4, context);
  const BrdfTable::Slices slices = table.slices(slice_view(9));
  const Vec2 center{-0.25f, 0.125f};
  std::vector<float> values;
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x)
      values.push_back(
          luminance(table.mean(slices, center + kCell * Vec2(static_cast<float>(x) - 3.5f, static_cast<float>(y) - 3.5f), kCellRadius)));
  }
  const Moments direct = moments_of(values), table_moments = table.moments(slices, center, 4 * kCell * std::sqrt(2.f));
  EXPECT_NEAR(table_moments.mean / direct.mean, 1, 1e-3f);
  EXPECT_NEAR(table_moments.deviation / direct.deviation, 1, 1e-3f);
}

TEST(BrdfTable, ModelsSayWhetherTheyAreIsotropic) {
  EXPECT_TRUE(is_isotropic(Bsdf(Lambert{})));
  EXPECT_TRUE(is_isotropic(metal(0.2f, 0.2f)));
  EXPECT_FALSE(is_isotropic(metal(0.2f, 0.3f)));
  EXPECT_FALSE(is_isotropic(Bsdf(Dielectric(1.5f, Ggx(0.2f, 0.1f), false))));
  EXPECT_FALSE(is_isotropic(Bsdf(CoatedDiffuse(Color(0.5f), 1.5f, Ggx(0.2f, 0.1f)))));
}

TEST(BrdfTable, StopsWhenCancelled) {
  Context context;
  context.cancelled = true;
  EXPECT_THROW(BrdfTable::build(metal(0.2f, 0.3f), 4, context), Error);
}

}  // namespace
}  // namespace sightline::square_lights
