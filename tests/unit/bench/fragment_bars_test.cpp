#include "bench/fragments/bars.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace sightline {
namespace {

// Error falls as 1 / n, time is 0.1 s and 10 ms a sample, 10 dB a decade.
std::array<CurvePoint, 4> curve() {
  std::array<CurvePoint, 4> points;
  int samples = 4;
  for (CurvePoint& point : points) {
    point = {samples, {0.1 + 0.01 * samples, 1.0 / samples, 10 * std::log10(static_cast<double>(samples))}};
    samples *= 4;
  }
  return points;
}

TEST(FragmentBars, EqualErrorTakesTheSmallestMeasuredNumberThatIsNoWorse) {
  const EqualError bar = equal_error(curve(), {0.2, 1 / 16.0, 0});
  EXPECT_EQ(bar.samples, 16);
  EXPECT_DOUBLE_EQ(bar.ratio, 0.26 / 0.2);
  ASSERT_TRUE(bar.interpolated_samples);
  EXPECT_NEAR(*bar.interpolated_samples, 16, 1e-9);
  EXPECT_NEAR(*bar.interpolated_ratio, 0.26 / 0.2, 1e-9);
}

TEST(FragmentBars, BetweenMeasuredNumbersErrorIsAPowerAndTimeIsLinear) {
  const EqualError bar = equal_error(curve(), {0.1, 1 / 32.0, 0});
  EXPECT_EQ(bar.samples, 64);
  EXPECT_NEAR(bar.ratio, 7.4, 1e-12);
  ASSERT_TRUE(bar.interpolated_samples);
  EXPECT_NEAR(*bar.interpolated_samples, 32, 1e-9);
  EXPECT_NEAR(*bar.interpolated_ratio, 0.42 / 0.1, 1e-9);
}

TEST(FragmentBars, OutsideOfTheCurveNothingIsInterpolated) {
  // Worse than the first: the first is already no worse.
  const EqualError worse = equal_error(curve(), {0.07, 0.5, 0});
  EXPECT_EQ(worse.samples, 4);
  EXPECT_NEAR(worse.ratio, 2, 1e-12);
  EXPECT_FALSE(worse.interpolated_ratio);
  // Better than the last: a lower bound, without a number.
  const EqualError better = equal_error(curve(), {0.1, 1e-4, 0});
  EXPECT_EQ(better.samples, 0);
  EXPECT_NEAR(better.ratio, 26.6, 1e-9);
  EXPECT_FALSE(better.interpolated_ratio);
}

TEST(FragmentBars, EqualTimeInterpolatesOverTheLogarithmOfTime) {
  const auto points = curve();
  EXPECT_NEAR(*equal_time_gain(points, {points[1].value.seconds, 0, 20}), 20 - points[1].value.psnr, 1e-9);
  const double middle = std::sqrt(points[1].value.seconds * points[2].value.seconds);
  EXPECT_NEAR(*equal_time_gain(points, {middle, 0, 20}), 20 - 0.5 * (points[1].value.psnr + points[2].value.psnr), 1e-9);
}

TEST(FragmentBars, EqualTimeIsALowerBoundBelowTheCurveAndNothingAboveIt) {
  const auto points = curve();
  EXPECT_NEAR(*equal_time_gain(points, {0.01, 0, 20}), 20 - points[0].value.psnr, 1e-12);
  EXPECT_FALSE(equal_time_gain(points, {100, 0, 20}));
  EXPECT_FALSE(equal_time_gain({}, {1, 0, 20}));
}

TEST(FragmentBars, TimeRatioIsOfTheNumberAskedForAlone) {
  EXPECT_NEAR(*time_ratio(curve(), 64, {0.37, 0, 0}), 2, 1e-12);
  EXPECT_FALSE(time_ratio(curve(), 32, {0.37, 0, 0}));
}

TEST(FragmentBars, LargestDeviationIsRelativeToTheMean) {
  EXPECT_DOUBLE_EQ(largest_deviation(std::array{1.0, 2.0, 3.0}), 0.5);
  EXPECT_DOUBLE_EQ(largest_deviation(std::array{1.0, 1.0, 4.0}), 1);
  EXPECT_EQ(largest_deviation(std::array{5.0}), 0);
  EXPECT_EQ(largest_deviation({}), 0);
}

}  // namespace
}  // namespace sightline
