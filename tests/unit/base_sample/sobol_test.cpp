#include "base/sample/sobol.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "base/core/aligned.h"

namespace sightline {
namespace {

TEST(Sobol, EveryPrefixOfAPowerOfTwoIsStratifiedInBothDimensionsAndTogether) {
  for (const std::uint32_t key : {pixel_key(0, 0), pixel_key(7, 1234)}) {
    for (const std::uint32_t pair : {0u, 1u, 5u}) {
      // 64 points: one in each elementary interval 64x1, 32x2, ..., 1x64.
      for (int split = 0; split <= 6; ++split) {
        std::set<std::pair<int, int>> cells;
        for (std::uint32_t i = 0; i < 64; ++i) {
          const Vec2 p = sobol_2d(key, i, pair);
          cells.insert({static_cast<int>(p.x * static_cast<float>(1 << split)), static_cast<int>(p.y * static_cast<float>(64 >> split))});
        }
        EXPECT_EQ(cells.size(), 64u) << "split " << split;
      }
    }
  }
}

TEST(Sobol, VectorVersionEqualsTheScalarDefinition) {
  constexpr std::size_t kCount = 1000;
  AlignedVector<std::uint32_t> keys(padded(kCount)), indices(padded(kCount));
  AlignedVector<float> u(padded(kCount)), v(padded(kCount));
  for (std::size_t i = 0; i < kCount; ++i) {
    keys[i] = pixel_key(3, static_cast<std::uint32_t>(i / 10));
    indices[i] = static_cast<std::uint32_t>(i * 2654435761u);
  }
  for (const std::uint32_t pair : {0u, 3u, 77u}) {
    sobol_2d(keys.data(), indices.data(), pair, kCount, u.data(), v.data());
    for (std::size_t i = 0; i < kCount; ++i) {
      const Vec2 expected = sobol_2d(keys[i], indices[i], pair);
      ASSERT_EQ(u[i], expected.x);
      ASSERT_EQ(v[i], expected.y);
    }
    sobol_1d(keys.data(), indices.data(), pair, kCount, v.data());
    for (std::size_t i = 0; i < kCount; ++i) ASSERT_EQ(v[i], u[i]);
  }
}

TEST(Sobol, PixelsAndPairsAreUncorrelated) {
  // Correlation of the same sample index over pixels, and of neighbouring pairs: |r| < 5 / sqrt(n).
  constexpr int kCount = 20000;
  double pixel_sum = 0, pair_sum = 0, cross_sum = 0;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const Vec2 a = sobol_2d(pixel_key(0, i), 3, 2) - 0.5f;
    const Vec2 b = sobol_2d(pixel_key(0, i + 1), 3, 2) - 0.5f;
    const Vec2 c = sobol_2d(pixel_key(0, i), 3, 3) - 0.5f;
    pixel_sum += a.x * b.x;
    pair_sum += a.x * c.x;
    cross_sum += a.x * a.y;
  }
  const double bound = 5.0 / std::sqrt(kCount) / 12.0;
  EXPECT_LT(std::abs(pixel_sum / kCount), bound);
  EXPECT_LT(std::abs(pair_sum / kCount), bound);
  EXPECT_LT(std::abs(cross_sum / kCount), bound);
}

TEST(Sobol, MarginalsAreUniform) {
  // Chi-square over 64 bins of 64 pixels x 100 samples (not a power of two), 63 degrees of freedom: 5 sigma = 63 + 5 sqrt(126).
  std::vector<double> bins(64);
  for (std::uint32_t pixel = 0; pixel < 64; ++pixel) {
    for (std::uint32_t i = 0; i < 100; ++i) bins[static_cast<std::size_t>(sobol_2d(pixel_key(1, pixel), i, 4).x * 64)] += 1;
  }
  double chi = 0;
  for (const double count : bins) chi += (count - 100) * (count - 100) / 100;
  EXPECT_LT(chi, 63 + 5 * std::sqrt(126.0));
}

}  // namespace
}  // namespace sightline
