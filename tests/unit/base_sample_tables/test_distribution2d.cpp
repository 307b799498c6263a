#include "base/sample/distribution2d.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/chi_square.h"

namespace sightline {
namespace {

constexpr std::uint32_t kWidth = 5, kHeight = 4;
const std::vector<float> kValues{1, 2, 0, 0, 3, 0, 0, 0, 0, 0, 0.5f, 0, 4, 0, 0, 7, 7, 1, 0.1f, 0};

TEST(Distribution2D, DensityIsTheGridOverItsMean) {
  const Distribution2D d(kValues, kWidth, kHeight);
  double sum = 0;
  for (const float v : kValues) sum += v;
  EXPECT_NEAR(d.mean(), sum / 20, 1e-12);
  double integral = 0;
  for (std::uint32_t y = 0; y < kHeight; ++y) {
    for (std::uint32_t x = 0; x < kWidth; ++x) {
      const Vec2 uv{(static_cast<float>(x) + 0.3f) / kWidth, (static_cast<float>(y) + 0.8f) / kHeight};
      EXPECT_NEAR(d.pdf(uv), kValues[y * kWidth + x] / (sum / 20), 1e-5);
      integral += d.pdf(uv) / 20;
    }
  }
  EXPECT_NEAR(integral, 1, 1e-6);
  EXPECT_EQ(d.pdf({1.5f, 0.5f}), 0);
  EXPECT_EQ(d.pdf({NAN, 0.5f}), 0);
}

TEST(Distribution2D, SamplesFollowTheDensityAndCarryIt) {
  const Distribution2D d(kValues, kWidth, kHeight);
  test::Uniform random(3);
  // Cells four times finer than the grid: also the place inside a cell is uniform.
  std::vector<double> observed(kWidth * kHeight * 16), expected(observed.size());
  constexpr int count = 200000;
  for (int i = 0; i < count; ++i) {
    const Distribution2D::Sample s = d.sample(random.next2());
    ASSERT_EQ(s.pdf, d.pdf(s.uv));
    ASSERT_GT(s.pdf, 0);
    ++observed[static_cast<std::size_t>(s.uv.y * kHeight * 4) * kWidth * 4 + static_cast<std::size_t>(s.uv.x * kWidth * 4)];
  }
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const std::size_t x = i % (kWidth * 4) / 4, y = i / (kWidth * 4) / 4;
    expected[i] = count * kValues[y * kWidth + x] / (d.mean() * 20) / 16;
  }
  const auto result = test::chi_square(observed, expected);
  EXPECT_GT(result.p_value, 1e-4) << result.table;
}

TEST(Distribution2D, MapIsMonotonic) {
  const Distribution2D d(kValues, kWidth, kHeight);
  float last = -1;
  for (int i = 0; i < 1000; ++i) {
    const float v = d.sample({0.5f, static_cast<float>(i) / 1000}).uv.y;
    EXPECT_GE(v, last);
    last = v;
  }
}

TEST(Distribution2D, EndsOfTheIntervalStayWhereThereIsWeight) {
  const std::vector<float> values{0, 0, 1, 0, 0, 0, 0, 0, 0};
  const Distribution2D d(values, 3, 3);
  for (const float a : {0.f, 0.5f, 0x1.fffffep-1f, 1.f}) {
    for (const float b : {0.f, 0.5f, 0x1.fffffep-1f, 1.f}) {
      const Distribution2D::Sample s = d.sample({a, b});
      EXPECT_EQ(s.x, 2u);
      EXPECT_EQ(s.y, 0u);
      EXPECT_EQ(s.pdf, d.pdf(s.uv));
      EXPECT_NEAR(s.pdf, 9, 1e-5);
    }
  }
  EXPECT_FALSE(Distribution2D(std::vector<float>(9), 3, 3).can_sample());
  EXPECT_EQ(Distribution2D(std::vector<float>(9), 3, 3).pdf({0.5f, 0.5f}), 0);
}

}  // namespace
}  // namespace sightline
