#include <gtest/gtest.h>

#include <cmath>

#include "base/core/error.h"
#include "image/io/image_io.h"
#include "unit/image/test_pictures.h"

namespace sightline {
namespace {

using test::append;
using test::bytes_of;
using test::random_picture;

std::vector<std::byte> hdr(std::string_view resolution, std::initializer_list<int> pixels, std::string_view lines = "") {
  std::vector<std::byte> bytes =
      bytes_of("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n" + std::string(lines) + "\n" + std::string(resolution) + "\n");
  append(bytes, pixels);
  return bytes;
}

TEST(Hdr, RoundTripIsWithinHalfAMantissaStepOfTheLargestComponent) {
  for (const int width : {1, 7, 8, 200, 1000}) {
    const ColorImage image = random_picture(width, 9, static_cast<unsigned>(width));
    const Image back = parse_image(encode_hdr(image), "x.hdr");
    ASSERT_EQ(back.width, width);
    ASSERT_EQ(back.height, 9);
    for (int y = 0; y < 9; ++y) {
      for (int x = 0; x < width; ++x) {
        const float tolerance = max_component(image.at(x, y)) / 255;
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(back.value(x, y, c), image.at(x, y)[c], tolerance) << width;
      }
    }
  }
}

TEST(Hdr, KnownPixels) {
  const Image image = parse_image(hdr("-Y 1 +X 2", {128, 64, 0, 129, 255, 255, 255, 0}), "x.hdr");
  EXPECT_EQ(image.value(0, 0, 0), 1.0f);
  EXPECT_EQ(image.value(0, 0, 1), 0.5f);
  EXPECT_EQ(image.value(0, 0, 2), 0.0f);
  for (int c = 0; c < 3; ++c) EXPECT_EQ(image.value(1, 0, c), 0.0f);
}

TEST(Hdr, ValuesThatRgbeCannotHoldStayFinite) {
  ColorImage image(4, 1);
  image.pixels = {Color(-1, NAN, 2), Color(INFINITY, 0, 0), Color(1e-45f), Color(0.99999f)};
  const Image back = parse_image(encode_hdr(image), "x.hdr");
  EXPECT_EQ(back.value(0, 0, 0), 0);
  EXPECT_EQ(back.value(0, 0, 1), 0);
  EXPECT_EQ(back.value(0, 0, 2), 2);
  EXPECT_GT(back.value(1, 0, 0), 1e38f);
  EXPECT_TRUE(std::isfinite(back.value(1, 0, 0)));
  EXPECT_EQ(back.value(2, 0, 0), 0);
  EXPECT_EQ(back.value(3, 0, 0), 1);
}

TEST(Hdr, OldRunsRepeatTheLastPixelAndGrowByShifts) {
  // One pixel, a run of 2, then one of 1 << 8 and 3: 1 + 2, a new pixel, 3 + 256.
  const Image image = parse_image(hdr("-Y 1 +X 263", {128, 0, 0, 129, 1, 1, 1, 2, 0, 128, 0, 129, 1, 1, 1, 3, 1, 1, 1, 1}), "x.hdr");
  for (int x = 0; x < 263; ++x) {
    EXPECT_EQ(image.value(x, 0, 0), x < 3 ? 1 : 0);
    EXPECT_EQ(image.value(x, 0, 1), x < 3 ? 0 : 1);
  }
  EXPECT_THROW(parse_image(hdr("-Y 1 +X 4", {1, 1, 1, 4}), "x.hdr"), Error);
  EXPECT_THROW(parse_image(hdr("-Y 1 +X 4", {128, 0, 0, 129, 1, 1, 1, 4}), "x.hdr"), Error);
}

TEST(Hdr, AllOrientationsShowTheSamePicture) {
  // A 2 x 2 picture whose red is 1 2 / 3 4; the mantissa carries it.
  const auto red = [](int a, int b, int c, int d) -> std::vector<std::byte> {
    std::vector<std::byte> pixels;
    for (const int value : {a, b, c, d}) append(pixels, {value * 16, 0, 0, 132});
    return pixels;
  };
  const std::vector<std::pair<std::string_view, std::vector<std::byte>>> cases = {
      {"-Y 2 +X 2", red(1, 2, 3, 4)}, {"+Y 2 +X 2", red(3, 4, 1, 2)}, {"-Y 2 -X 2", red(2, 1, 4, 3)}, {"+Y 2 -X 2", red(4, 3, 2, 1)},
      {"+X 2 -Y 2", red(1, 3, 2, 4)}, {"+X 2 +Y 2", red(3, 1, 4, 2)}, {"-X 2 -Y 2", red(2, 4, 1, 3)}, {"-X 2 +Y 2", red(4, 2, 3, 1)}};
  for (const auto& [resolution, pixels] : cases) {
    std::vector<std::byte> bytes = hdr(resolution, {});
    bytes.insert(bytes.end(), pixels.begin(), pixels.end());
    const Image image = parse_image(bytes, "x.hdr");
    for (int i = 0; i < 4; ++i) EXPECT_EQ(image.value(i % 2, i / 2, 0), static_cast<float>(i + 1)) << resolution;
  }
}

TEST(Hdr, ExposureIsDividedOutAndXyzBecomesRec709) {
  EXPECT_EQ(parse_image(hdr("-Y 1 +X 1", {128, 128, 128, 129}, "EXPOSURE=2\nEXPOSURE= 2.0\n"), "x.hdr").value(0, 0, 0), 0.25f);
  std::vector<std::byte> white = bytes_of("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n");
  append(white, {122, 128, 139, 129});  // X Y Z of D65 to 8 bits
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(parse_image(white, "x.hdr").value(0, 0, c), 1, 0.02f);
}

TEST(Hdr, HugeClaimsAreRefused) {
  EXPECT_THROW(parse_image(hdr("-Y 40000 +X 40000", {}), "x.hdr"), Error);
  EXPECT_THROW(parse_image(hdr("-Y 2147483647 +X 2147483647", {1, 2, 3, 4}), "x.hdr"), Error);
  EXPECT_THROW(parse_image(hdr("-Y 99999999999 +X 1", {1, 2, 3, 4}), "x.hdr"), Error);
}

}  // namespace
}  // namespace sightline
