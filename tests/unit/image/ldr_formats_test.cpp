#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "base/core/error.h"
#include "image/io/image_io.h"
#include "unit/image/test_pictures.h"

namespace sightline {
namespace {

using test::append;
using test::bytes_of;
using test::random_bytes;

TEST(Png, RoundTripIsExact) {
  for (const int channels : {3, 4}) {
    const std::vector<std::uint8_t> pixels = random_bytes(static_cast<std::size_t>(31 * 17 * channels), 5);
    const Image back = parse_image(encode_png(31, 17, channels, pixels), "x.png");
    ASSERT_EQ(back.width, 31);
    ASSERT_EQ(back.height, 17);
    ASSERT_EQ(back.channels, channels);
    EXPECT_EQ(std::get<Image::Bytes>(back.data), pixels);
  }
}

/// Made by hand: a 2 x 1 picture of the given depth and colour type with stored (uncompressed) data.
std::vector<std::byte> small_png(int depth, int color_type, std::initializer_list<int> row, std::initializer_list<int> palette = {},
                                 std::initializer_list<int> transparency = {}) {
  std::vector<std::byte> png;
  append(png, {0x89, 'P', 'N', 'G', 13, 10, 26, 10});
  const auto chunk = [&png](std::string_view type, const std::vector<std::byte>& data) {
    const auto size = static_cast<int>(data.size());
    append(png, {size >> 24, size >> 16 & 255, size >> 8 & 255, size & 255});
    std::vector<std::byte> body = bytes_of(type);
    body.insert(body.end(), data.begin(), data.end());
    std::uint32_t crc = 0xffffffff;
    for (const std::byte b : body) {
      crc ^= static_cast<std::uint32_t>(b);
      for (int bit = 0; bit < 8; ++bit) crc = crc & 1 ? crc >> 1 ^ 0xedb88320u : crc >> 1;
    }
    crc = ~crc;
    png.insert(png.end(), body.begin(), body.end());
    append(png,
           {static_cast<int>(crc >> 24), static_cast<int>(crc >> 16 & 255), static_cast<int>(crc >> 8 & 255), static_cast<int>(crc & 255)});
  };
  std::vector<std::byte> header, data;
  append(header, {0, 0, 0, 2, 0, 0, 0, 1, depth, color_type, 0, 0, 0});
  chunk("IHDR", header);
  if (palette.size() > 0) {
    std::vector<std::byte> colors;
    append(colors, palette);
    chunk("PLTE", colors);
  }
  if (transparency.size() > 0) {
    std::vector<std::byte> alphas;
    append(alphas, transparency);
    chunk("tRNS", alphas);
  }
  const auto size = static_cast<int>(row.size()) + 1;  // with the filter's byte
  append(data, {0x78, 0x01, 1, size, 0, 255 - size, 255, 0});
  append(data, row);
  std::uint32_t a = 1, b = 1;
  for (const int value : row) {
    a = (a + static_cast<std::uint32_t>(value)) % 65521;
    b = (b + a) % 65521;
  }
  append(data, {static_cast<int>(b >> 8), static_cast<int>(b & 255), static_cast<int>(a >> 8), static_cast<int>(a & 255)});
  chunk("IDAT", data);
  chunk("IEND", {});
  return png;
}

TEST(Png, SixteenBitsKeepTheirValues) {
  const Image image = parse_image(small_png(16, 0, {0x12, 0x34, 0xff, 0xff}), "x.png");
  EXPECT_EQ(std::get<Image::Words>(image.data), (Image::Words{0x1234, 0xffff}));
  EXPECT_EQ(image.value(1, 0, 0), 1.0f);
}

TEST(Png, PalettesBitsAndGreyWithAlphaAreExpanded) {
  const Image palette = parse_image(small_png(8, 3, {1, 0}, {10, 20, 30, 40, 50, 60}), "x.png");
  EXPECT_EQ(std::get<Image::Bytes>(palette.data), (Image::Bytes{40, 50, 60, 10, 20, 30}));
  const Image transparent = parse_image(small_png(8, 3, {1, 0}, {10, 20, 30, 40, 50, 60}, {99}), "x.png");
  EXPECT_EQ(std::get<Image::Bytes>(transparent.data), (Image::Bytes{40, 50, 60, 255, 10, 20, 30, 99}));
  const Image bits = parse_image(small_png(1, 0, {0x40}), "x.png");
  EXPECT_EQ(std::get<Image::Bytes>(bits.data), (Image::Bytes{0, 255}));
  const Image grey = parse_image(small_png(8, 4, {7, 100, 8, 200}), "x.png");
  EXPECT_EQ(grey.channels, 4);
  EXPECT_EQ(std::get<Image::Bytes>(grey.data), (Image::Bytes{7, 7, 7, 100, 8, 8, 8, 200}));
}

TEST(Jpeg, RoundTripIsCloseAndTheSameEachTime) {
  std::vector<std::uint8_t> pixels;
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 50; ++x) pixels.insert(pixels.end(), {static_cast<std::uint8_t>(5 * x), static_cast<std::uint8_t>(6 * y), 90});
  }
  const std::vector<std::byte> bytes = encode_jpeg(50, 40, pixels);
  EXPECT_EQ(bytes, encode_jpeg(50, 40, pixels));
  const Image back = parse_image(bytes, "x.jpg");
  ASSERT_EQ(back.channels, 3);
  const auto& values = std::get<Image::Bytes>(back.data);
  ASSERT_EQ(values.size(), pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) ASSERT_LE(std::abs(values[i] - pixels[i]), 12);
}

std::vector<std::byte> tga(int type, int width, int height, int bits, int descriptor, std::initializer_list<int> pixels) {
  std::vector<std::byte> bytes;
  append(bytes, {0, 0, type, 0, 0, 0, 0, 0, 0, 0, 0, 0, width & 255, width >> 8, height & 255, height >> 8, bits, descriptor});
  append(bytes, pixels);
  return bytes;
}

TEST(Tga, RowsMayComeFromEitherEndAndRunsAreExpanded) {
  const Image bottom_up = parse_image(tga(2, 1, 2, 24, 0, {1, 2, 3, 4, 5, 6}), "x.tga");
  EXPECT_EQ(std::get<Image::Bytes>(bottom_up.data), (Image::Bytes{6, 5, 4, 3, 2, 1}));
  const Image top_down = parse_image(tga(2, 1, 2, 24, 32, {1, 2, 3, 4, 5, 6}), "x.tga");
  EXPECT_EQ(std::get<Image::Bytes>(top_down.data), (Image::Bytes{3, 2, 1, 6, 5, 4}));
  const Image runs = parse_image(tga(11, 5, 1, 8, 32, {0x82, 9, 0x01, 7, 8}), "x.tga");
  EXPECT_EQ(std::get<Image::Bytes>(runs.data), (Image::Bytes{9, 9, 9, 7, 8}));
  EXPECT_THROW(parse_image(tga(2, 65535, 65535, 32, 0, {}), "x.tga"), Error);
  EXPECT_THROW(parse_image(tga(11, 5, 1, 8, 32, {0x82, 9, 0x01, 7}), "x.tga"), Error);
}

TEST(Bmp, RowsArePaddedAndComeFromTheBottom) {
  std::vector<std::byte> bytes = bytes_of("BM");
  append(bytes, {62, 0, 0, 0, 0, 0, 0, 0, 54, 0, 0, 0, 40, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 1, 0, 24, 0});
  append(bytes, {0, 0, 0, 0, 8, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  append(bytes, {1, 2, 3, 0, 4, 5, 6, 0});
  const Image image = parse_image(bytes, "x.bmp");
  EXPECT_EQ(std::get<Image::Bytes>(image.data), (Image::Bytes{6, 5, 4, 3, 2, 1}));
  bytes.pop_back();
  EXPECT_THROW(parse_image(bytes, "x.bmp"), Error);
}

}  // namespace
}  // namespace sightline
