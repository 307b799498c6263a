#include "bench/thumbnail.h"

#include <gtest/gtest.h>

namespace sightline {
namespace {

TEST(Thumbnail, HalvingKeepsMeans) {
  ColorImage image(4, 2);
  for (int x = 0; x < 4; ++x) image.at(x, 0) = Color(static_cast<float>(x)), image.at(x, 1) = Color(static_cast<float>(2 * x));
  const ColorImage half = halved(image);
  ASSERT_EQ(half.width, 2);
  ASSERT_EQ(half.height, 1);
  EXPECT_FLOAT_EQ(half.at(0, 0).x, 0.75f);
  EXPECT_FLOAT_EQ(half.at(1, 0).x, 3.75f);
}

TEST(Thumbnail, IsAtMostAsWideAsAsked) {
  EXPECT_EQ(thumbnail(ColorImage(1280, 960), 800).width, 640);
  EXPECT_EQ(thumbnail(ColorImage(100, 3), 800).width, 100);
  EXPECT_EQ(thumbnail(ColorImage(5, 1), 1).height, 1);
}

TEST(Thumbnail, ViewingExposureBringsTheMeanToAFifth) {
  EXPECT_NEAR(viewing_exposure(ColorImage(2, 2, Color(0.8f))), -2, 1e-4);
  EXPECT_EQ(viewing_exposure(ColorImage(2, 2, Color(0))), 0);
}

}  // namespace
}  // namespace sightline
