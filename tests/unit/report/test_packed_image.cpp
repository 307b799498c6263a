#include <gtest/gtest.h>
#include <half.h>
#include <zlib.h>

#include <cmath>
#include <limits>
#include <vector>

#include "report/packed_image.h"

namespace sightline {
namespace {

std::vector<std::uint8_t> bytes_of_base64(const std::string& text) {
  static const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  std::uint32_t group = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    group = group << 6 | static_cast<std::uint32_t>(digits.find(c));
    bits += 6;
    if (bits >= 8) bytes.push_back(static_cast<std::uint8_t>(group >> (bits -= 8)));
  }
  return bytes;
}

// What decode.js does, in C++.
ColorImage unpack(const PackedImage& packed) {
  const std::size_t count = static_cast<std::size_t>(packed.width) * static_cast<std::size_t>(packed.height);
  const auto width = static_cast<std::size_t>(packed.width);
  const std::vector<std::uint8_t> deflated = bytes_of_base64(packed.base64);
  std::vector<std::uint8_t> planes(6 * count);
  uLongf size = static_cast<uLongf>(planes.size());
  EXPECT_EQ(uncompress(planes.data(), &size, deflated.data(), static_cast<uLong>(deflated.size())), Z_OK);
  EXPECT_EQ(size, planes.size());
  ColorImage image(packed.width, packed.height);
  for (int c = 0; c < 3; ++c) {
    std::vector<std::uint16_t> bits(count);
    const std::uint8_t* high = planes.data() + 2 * static_cast<std::size_t>(c) * count;
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint16_t predicted = i == 0 ? std::uint16_t{0} : i % width != 0 ? bits[i - 1] : bits[i - width];
      bits[i] = static_cast<std::uint16_t>(predicted + (high[i] << 8 | high[count + i]));
      image.pixels[i][c] = imath_half_to_float(bits[i]);
    }
  }
  return image;
}

TEST(PackedImage, GivesThePictureBackWithinHalfPrecision) {
  ColorImage image(37, 23);
  std::uint32_t state = 7;
  for (Color& pixel : image.pixels) {
    for (int c = 0; c < 3; ++c) {
      state = state * 1664525u + 1013904223u;
      pixel[c] = std::exp2(static_cast<float>(state >> 8) * 0x1p-24f * 24 - 10) * (state & 1 ? 1.0f : -1.0f);
    }
  }
  const ColorImage back = unpack(pack_image(image));
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(back.pixels[i][c], image.pixels[i][c], 0x1p-11f * std::abs(image.pixels[i][c]));
  }
}

TEST(PackedImage, ClampsWhatHalfCannotHoldAndKeepsWhatIsNotFinite) {
  ColorImage image(2, 1);
  image.at(0, 0) = Color(1e9f, -1e9f, 70000.0f);
  image.at(1, 0) = Color(std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 0);
  const PackedImage packed = pack_image(image);
  const ColorImage back = unpack(packed);
  EXPECT_EQ(back.at(0, 0), Color(65504, -65504, 65504));
  EXPECT_TRUE(std::isnan(back.at(1, 0).x));
  EXPECT_TRUE(std::isinf(back.at(1, 0).y));
  EXPECT_NEAR(packed.mean_luminance, 65504 * (0.2126 - 0.7152 + 0.0722), 1e-6);
}

TEST(PackedImage, MeanIsThatOfTheRoundedPicture) {
  const PackedImage packed = pack_image(ColorImage(8, 8, Color(0.1f)));
  EXPECT_NEAR(packed.mean_luminance, imath_half_to_float(imath_float_to_half(0.1f)), 1e-9);
}

TEST(PackedImage, SmoothPicturesBecomeSmall) {
  ColorImage image(256, 256);
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) image.at(x, y) = Color(0.2f + 0.001f * static_cast<float>(x + y));
  }
  EXPECT_LT(pack_image(image).base64.size(), 256u * 256u * 6u / 4u);
}

}  // namespace
}  // namespace sightline
