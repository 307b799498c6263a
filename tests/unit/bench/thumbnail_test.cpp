#include "bench/thumbnail.h"

#include <gtest/gtest.h>

#include "bench/strip.h"

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

TEST(PictureStrip, ColumnsStandSideBySideAtHalfSizeAndOneExposure) {
  PictureStrip strip;
  EXPECT_FALSE(strip.image());
  const ColorImage bright(4, 2, Color(8)), dark(4, 2, Color(0.5f));
  strip.add({strip.exposed(bright, bright), dark});
  strip.add({strip.exposed(dark, dark), bright});
  const ColorImage image = strip.image().value();
  ASSERT_EQ(image.width, 4);
  ASSERT_EQ(image.height, 2);
  EXPECT_FLOAT_EQ(image.at(0, 0).x, 16 * image.at(2, 0).x);
  EXPECT_FLOAT_EQ(image.at(1, 1).x, 0.5f);
  EXPECT_FLOAT_EQ(image.at(3, 1).x, 8);
}

}  // namespace
}  // namespace sightline
