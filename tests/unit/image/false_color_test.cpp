#include "image/false_color.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sightline {
namespace {

TEST(FalseColor, LumaRisesFromBlackToNearlyWhite) {
  float last = -1;
  for (int i = 0; i <= 100; ++i) {
    const float luma = luminance(false_color(static_cast<float>(i) / 100));
    EXPECT_GT(luma, last);
    last = luma;
  }
  EXPECT_LT(luminance(false_color(0.0f)), 0.01f);
  EXPECT_GT(last, 0.9f);
}

TEST(FalseColor, ValuesAreClampedAndNanStandsOut) {
  const std::vector<float> values = {-1, 2, NAN, INFINITY};
  const std::vector<std::uint8_t> bytes = false_color(values, 0, 1);
  ASSERT_EQ(bytes.size(), 12u);
  EXPECT_EQ(bytes[0], 0);
  EXPECT_EQ(bytes[3], 255);
  EXPECT_EQ(bytes[7], 255);
  EXPECT_EQ(bytes[6], 0);
  EXPECT_EQ(bytes[9], 255);
}

}  // namespace
}  // namespace sightline
