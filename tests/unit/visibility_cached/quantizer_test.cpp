// Sizes and cells of [Popov2013, Eqs. 3-9] against what the equations demand.
#include "visibility/cached/quantizer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "cache_cases.h"

namespace sightline::test {
namespace {

constexpr double kRatio = 1.2;  // the paper's C_R, for which its examples hold

CachedVisibilitySettings with(const auto& change) {
  CachedVisibilitySettings settings;
  settings.level_ratio = static_cast<float>(kRatio);
  change(settings);
  return settings;
}

// Cells of nearly continuous levels: C_R as small as it may be.
CachedVisibilitySettings fine_levels() {
  return with([](auto& s) { s.level_ratio = 1.1f; });
}

double edge_of(const Quantizer& q, double level, double diameter) {
  return diameter / std::pow(2.0, level / q.constants().levels_per_octave);
}

TEST(Quantizer, PatchesHoldTheSquareOfCeSamples) {
  const Quantizer q(cube(1.5f), fine_levels());
  const double diameter = 2 * 1.5 * std::sqrt(3.0);
  for (const double ce : {0.5, 4.0, 8.0, 36.0}) {
    for (const double ax : {1e-6, 3e-4, 0.02}) {
      for (const double ay : {1e-5, 1e-3, 0.3}) {
        const double half = 0.5 * q.constants().levels_per_octave;
        // [Popov2013, Eq. 3] with cell areas for the densities: |A_e| |A_l| = C_E^2 a_x a_y.
        const double wanted = ce * ce * ax * ay;
        const double eye = edge_of(q, q.eye_offset(static_cast<float>(ce)) - half * std::log2(ax), diameter);
        const double light = edge_of(q, q.constants().light_offset - half * std::log2(ay), diameter);
        EXPECT_NEAR(eye * eye * light * light / wanted, 1, 1e-4);
        const double both = edge_of(q, q.symmetric_offset(static_cast<float>(ce)) - 0.5 * half * std::log2(ax * ay), diameter);
        EXPECT_NEAR(std::pow(both, 4) / wanted, 1, 1e-4);
      }
    }
  }
}

TEST(Quantizer, UniformSphereOf256SamplesHas256Cells) {
  // Mended Eq. 9: one expected sample a cell; the printed form makes one cell of the sphere.
  const double area = 4 * std::numbers::pi / 256;
  for (const bool printed : {false, true}) {
    const Quantizer q(cube(1), with([&](auto& s) { s.eq9_as_printed = printed; }));
    const double level = q.constants().sphere_offset - 0.5 * q.constants().levels_per_octave * std::log2(area);
    const double r = std::pow(kRatio, level);
    EXPECT_NEAR(r, printed ? 16 / (4 * std::numbers::pi) : 16, 1e-3);
    const EndWords words = q.light(QuerySemantic::solid_angle, {0, 1, 0}, Vec3(0), static_cast<float>(area));
    EXPECT_NEAR(q.resolution(words.level()), printed ? 1 : 15, 0.5);
    EXPECT_GE(q.resolution(q.light(QuerySemantic::solid_angle, {0, 1, 0}, Vec3(0), 12).level()), printed ? 1 : 2);
  }
}

TEST(Quantizer, LevelsFollowEquation8) {
  const Quantizer q(cube(1), with([](auto&) {}));
  const double diameter = 2 * std::sqrt(3.0) * (1 + 1e-5);
  for (double r = 1; r < 1e6; r *= 1.0137) {
    const double edge = diameter / r;
    const EndWords words = q.light(QuerySemantic::surface, Vec3(0.1f), {0, 0, 1}, static_cast<float>(edge * edge));
    ASSERT_FALSE(words.unknown());
    const double quantised = q.resolution(words.level());
    EXPECT_LE(std::fabs(words.level() - std::log(r) / std::log(kRatio)), 0.5 + 1e-3);
    if (r < 32) continue;
    EXPECT_LE(quantised / r, std::sqrt(kRatio) * 1.001);
    EXPECT_GE(quantised / r, 1 / std::sqrt(kRatio) * 0.97);  // floor
  }
  // Finer than floats can tell apart: not cached, rather than cached wrongly.
  EXPECT_TRUE(q.light(QuerySemantic::surface, Vec3(0.1f), {0, 0, 1}, 1e-14f).unknown());
}

TEST(Quantizer, QuantisedResolutionsQuantiseToThemselves) {
  const Quantizer q(cube(1), with([](auto&) {}));
  const double diameter = 2 * std::sqrt(3.0) * (1 + 1e-5);
  for (std::uint32_t k = 20; k < 76; ++k) {
    const double edge = diameter / q.resolution(k);
    EXPECT_EQ(q.light(QuerySemantic::surface, Vec3(0.1f), {0, 0, 1}, static_cast<float>(edge * edge)).level(), k);
  }
}

TEST(Quantizer, LogarithmIsGoodTo1e5) {
  double worst = 0;
  for (float x = 1.3e-36f; x < 1e36f; x *= 1.00371f)
    worst = std::fmax(worst, std::fabs(static_cast<double>(fast_log2(x)) - std::log2(static_cast<double>(x))));
  EXPECT_LT(worst, 2e-5);  // half of it the rounding of numbers near 120
}

TEST(Quantizer, NoisyFlatFloorIsOneOrientationIfRounded) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> noise(-1e-6f, 1e-6f);
  for (const CacheNormals normals : {CacheNormals::rounded, CacheNormals::floored}) {
    const Quantizer q(cube(1), with([&](auto& s) { s.normals = normals; }));
    std::set<std::uint32_t> bins;
    for (int i = 0; i < 1000; ++i) {
      const Vec3 n = glm::normalize(Vec3(noise(random), 1 + noise(random), noise(random)));
      bins.insert(q.locate(random_point(random, 1), n, 1e-4f).bins);
    }
    EXPECT_EQ(bins.size() == 1, normals == CacheNormals::rounded) << bins.size();
  }
}

TEST(Quantizer, CoordinatesStayInsideTheGrid) {
  std::mt19937 random(4);
  const Quantizer q(cube(1), {});
  std::uniform_real_distribution<float> exponent(-24, 0);
  for (int i = 0; i < 300000; ++i) {
    const EndWords w = q.light(QuerySemantic::surface, random_point(random, 1), random_direction(random), std::exp2(exponent(random)));
    ASSERT_FALSE(w.unknown());
    const auto r = static_cast<std::uint32_t>(q.resolution(w.level()));
    ASSERT_LT(w.x, r);
    ASSERT_LT(w.y, r);
    ASSERT_LT(w.z, 8 * r);
    for (int axis = 0; axis < 3; ++axis) ASSERT_LE(w.axis(axis), 8u);
  }
}

TEST(Quantizer, OrientationsLieNearTheNormal) {
  std::mt19937 random(5);
  const Quantizer q(cube(1), {});
  float worst = 1;
  for (int i = 0; i < 100000; ++i) {
    const Vec3 n = random_direction(random);
    const Mat3 axes = q.frame(q.locate(Vec3(0), n, 1).bins);
    worst = std::fmin(worst, glm::dot(axes[2], n));
    ASSERT_NEAR(glm::dot(glm::cross(axes[0], axes[1]), axes[2]), 1, 1e-5);
  }
  EXPECT_GT(worst, std::cos(11.5f * kPi / 180));
}

TEST(Quantizer, EqualAreaCellsHoldEqualShares) {
  std::mt19937 random(6);
  constexpr int kCells = 12, kCount = 200000;
  std::vector<int> counts(kCells * kCells), skewed(kCells * kCells);
  const auto cell = [&](const Vec2& uv) {
    const int u = std::min(static_cast<int>(uv.x * kCells), kCells - 1), v = std::min(static_cast<int>(uv.y * kCells), kCells - 1);
    return static_cast<std::size_t>(u + kCells * v);
  };
  for (int i = 0; i < kCount; ++i) {
    const Vec3 w = random_direction(random);
    const Vec2 uv = sphere_to_square(w, true), other = sphere_to_square(w, false);
    for (const float x : {uv.x, uv.y, other.x, other.y}) ASSERT_TRUE(x >= 0 && x <= 1.00001f);
    ++counts[cell(uv)], ++skewed[cell(other)];
  }
  const double expected = double{kCount} / (kCells * kCells);
  double chi = 0, chi_skewed = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    chi += (counts[i] - expected) * (counts[i] - expected) / expected;
    chi_skewed += (skewed[i] - expected) * (skewed[i] - expected) / expected;
  }
  EXPECT_LT(chi, 143 + 5 * std::sqrt(2 * 143.0));
  EXPECT_GT(chi_skewed, 10000);  // octahedral: cells differ by a factor of five
}

TEST(Quantizer, NonsenseIsNotCached) {
  const Quantizer q(cube(1), {});
  const float nan = std::nanf(""), infinity = std::numeric_limits<float>::infinity();
  for (const float area : {0.f, -1.f, nan, infinity}) {
    EXPECT_TRUE(q.eye(q.locate(Vec3(0), {0, 0, 1}, area), q.eye_offset(8)).unknown());
    EXPECT_TRUE(q.light(QuerySemantic::solid_angle, {0, 0, 1}, Vec3(0), area).unknown());
  }
  EXPECT_TRUE(q.eye(q.locate({nan, 0, 0}, {0, 0, 1}, 1), q.eye_offset(8)).unknown());
  EXPECT_TRUE(q.eye(q.locate({0, 1e9f, 0}, {0, 0, 1}, 1), q.eye_offset(8)).unknown());
  const Quantizer empty(Bounds(), {});
  EXPECT_TRUE(empty.eye(empty.locate(Vec3(0), {0, 0, 1}, 1), empty.eye_offset(8)).unknown());
}

TEST(Quantizer, MinusZeroIsZero) {
  const Quantizer q(cube(1), {});
  EXPECT_EQ(q.light(QuerySemantic::point, {-0.f, 1, 2}, Vec3(0), 0), q.light(QuerySemantic::point, {0.f, 1, 2}, Vec3(0), 0));
  EXPECT_FALSE(q.light(QuerySemantic::point, {0, 1, 2}, Vec3(0), 0) == q.light(QuerySemantic::direction, {0, 1, 2}, Vec3(0), 0));
}

}  // namespace
}  // namespace sightline::test
