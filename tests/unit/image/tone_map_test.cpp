#include "image/tone_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/core/error.h"

namespace sightline {
namespace {

TEST(ToneMap, SrgbCurveHasItsPublishedValuesAndInverse) {
  EXPECT_NEAR(srgb_from_linear(0.001f), 0.01292f, 1e-6f);
  EXPECT_NEAR(srgb_from_linear(0.18f), 0.46135613f, 1e-6f);
  EXPECT_NEAR(srgb_from_linear(0.5f), 0.73535698f, 1e-6f);
  EXPECT_NEAR(linear_from_srgb(0.5f), 0.21404114f, 1e-6f);
  for (int i = 0; i <= 255; ++i) {
    const float value = static_cast<float>(i) / 255;
    EXPECT_NEAR(srgb_from_linear(linear_from_srgb(value)), value, 1e-6f);
  }
}

TEST(ToneMap, CurvesHaveTheValuesOfTheirFormulas) {
  EXPECT_EQ(tone_curve(0.25f, ToneMap::srgb), 0.25f);
  EXPECT_NEAR(tone_curve(1, ToneMap::reinhard), 0.5f, 1e-7f);
  EXPECT_NEAR(tone_curve(3, ToneMap::reinhard), 0.75f, 1e-7f);
  // (2.51 + 0.03) / (2.43 + 0.59 + 0.14)
  EXPECT_NEAR(tone_curve(1, ToneMap::aces), 2.54f / 3.16f, 1e-6f);
  // Hable's white point 11.2 is reached at half of it, because of the exposure bias of 2.
  EXPECT_NEAR(tone_curve(5.6f, ToneMap::filmic), 1, 1e-5f);
  const auto hable = [](double x) { return (x * (0.15 * x + 0.05) + 0.004) / (x * (0.15 * x + 0.5) + 0.06) - 0.02 / 0.3; };
  EXPECT_NEAR(tone_curve(0.5f, ToneMap::filmic), hable(1) / hable(11.2), 1e-6);
}

TEST(ToneMap, EveryCurveStartsAtBlackRisesAndStaysInRange) {
  for (const ToneMap curve : {ToneMap::srgb, ToneMap::reinhard, ToneMap::aces, ToneMap::filmic}) {
    EXPECT_NEAR(tone_curve(0, curve), 0, 1e-7f);
    float last = 0;
    for (float x = 1e-4f; x < 1e38f; x *= 1.5f) {
      const float value = tone_curve(x, curve);
      EXPECT_GE(value, last - 1e-6f);
      EXPECT_LE(value, 1);
      last = value;
    }
    EXPECT_NEAR(tone_curve(std::numeric_limits<float>::infinity(), curve), 1, 1e-6f);
    EXPECT_NEAR(tone_curve(std::numeric_limits<float>::quiet_NaN(), curve), 0, 1e-7f);
    EXPECT_NEAR(tone_curve(-5, curve), 0, 1e-7f);
  }
}

TEST(ToneMap, ExposureIsInStopsAndBytesAreRounded) {
  EXPECT_NEAR(tone_map(Color(0.125f), ToneMap::srgb, 2)[0], srgb_from_linear(0.5f), 1e-6f);
  const ColorImage image(2, 1, Color(0.5f, 0, 7));
  EXPECT_EQ(to_srgb8(image), (std::vector<std::uint8_t>{188, 0, 255, 188, 0, 255}));
}

TEST(ToneMap, UnknownNamesListTheKnownOnes) {
  EXPECT_EQ(tone_map_from_name("filmic"), ToneMap::filmic);
  try {
    tone_map_from_name("film");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    EXPECT_NE(std::string(error.what()).find("reinhard"), std::string::npos);
  }
}

}  // namespace
}  // namespace sightline
