#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/core/error.h"
#include "image/io/image_io.h"
#include "unit/image/test_pictures.h"

namespace sightline {
namespace {

using test::layers_of;
using test::random_picture;

TEST(Exr, FloatLayersComeBackBitForBitWithTheirMetadata) {
  LayeredImage image = layers_of(random_picture(37, 21, 1), false);
  image.channels.push_back({"depth.Z", false, std::vector<float>(37 * 21, 1e30f)});
  image.channels.push_back({"albedo.R", true, std::vector<float>(37 * 21, 0.5f)});
  image.metadata = {{"sightline:seed", "7"}, {"comments", "two\nlines"}};
  for (const ExrCompression compression : {ExrCompression::none, ExrCompression::rle, ExrCompression::zip, ExrCompression::piz}) {
    const LayeredImage back = parse_exr(encode_exr(image, {compression}), "x.exr");
    ASSERT_EQ(back.width, 37);
    ASSERT_EQ(back.height, 21);
    ASSERT_EQ(back.channels.size(), image.channels.size());
    for (const Channel& channel : image.channels) {
      const Channel* found = back.find(channel.name);
      ASSERT_NE(found, nullptr) << channel.name;
      EXPECT_EQ(found->half, channel.half);
      EXPECT_EQ(found->values, channel.values) << channel.name;
    }
    for (const auto& entry : image.metadata) EXPECT_NE(std::find(back.metadata.begin(), back.metadata.end(), entry), back.metadata.end());
  }
}

TEST(Exr, HalvesAreRoundedToElevenBitsAndStayFinite) {
  LayeredImage image{3, 1, {{"Y", true, {0.1f, 1e9f, -1e9f}}}, {}};
  const LayeredImage back = parse_exr(encode_exr(image), "x.exr");
  EXPECT_NEAR(back.channels[0].values[0], 0.1f, 0.1f / 2048);
  EXPECT_EQ(back.channels[0].values[1], 65504.0f);
  EXPECT_EQ(back.channels[0].values[2], -65504.0f);
}

TEST(Exr, DwabIsCloseToTheOriginal) {
  ColorImage smooth(64, 64);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) smooth.at(x, y) = Color(0.2f + 0.01f * static_cast<float>(x), 0.5f, 0.3f + 0.005f * static_cast<float>(y));
  }
  const ColorImage back = color_of(parse_exr(encode_exr(layers_of(smooth, true), {ExrCompression::dwab}), "x.exr"));
  for (std::size_t i = 0; i < back.pixels.size(); ++i) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(back.pixels[i][c], smooth.pixels[i][c], 0.02f);
  }
}

TEST(Exr, EqualPicturesGiveEqualBytes) {
  const LayeredImage image = layers_of(random_picture(100, 50, 2), true);
  EXPECT_EQ(encode_exr(image), encode_exr(image));
}

TEST(Exr, ColourIsRgbAElseYElseTheOnlyChannel) {
  const auto parse = [](std::vector<Channel> channels) { return parse_image(encode_exr({1, 1, std::move(channels), {}}), "x.exr"); };
  const Image rgba = parse({{"R", false, {1}}, {"G", false, {2}}, {"B", false, {3}}, {"A", false, {4}}, {"Z", false, {9}}});
  ASSERT_EQ(rgba.channels, 4);
  for (int c = 0; c < 4; ++c) EXPECT_EQ(rgba.value(0, 0, c), static_cast<float>(c + 1));
  EXPECT_EQ(parse({{"Y", false, {5}}, {"Z", false, {9}}}).value(0, 0, 0), 5);
  EXPECT_EQ(parse({{"anything", false, {6}}}).value(0, 0, 0), 6);
  const Image green = parse({{"G", false, {7}}, {"Z", false, {9}}});
  ASSERT_EQ(green.channels, 3);
  EXPECT_EQ(green.value(0, 0, 0), 0);
  EXPECT_EQ(green.value(0, 0, 1), 7);
  EXPECT_THROW(parse({{"U", false, {1}}, {"V", false, {1}}}), Error);
}

TEST(Exr, WhatCannotBeWrittenIsAUsageError) {
  const auto refused = [](const LayeredImage& image) {
    try {
      encode_exr(image);
    } catch (const Error& error) {
      return error.code() == ErrorCode::usage;
    }
    return false;
  };
  EXPECT_TRUE(refused({0, 0, {}, {}}));
  EXPECT_TRUE(refused({2, 2, {{"R", false, {1}}}, {}}));
  EXPECT_TRUE(refused({1, 1, {{"R", false, {1}}, {"R", false, {1}}}, {}}));
  EXPECT_TRUE(refused({1, 1, {{"R", false, {1}}}, {{"dataWindow", "no"}}}));
}

TEST(Exr, AHeaderThatClaimsTooMuchIsRefusedBeforeMemoryIsTaken) {
  const std::vector<std::byte> good = encode_exr(layers_of(random_picture(8, 8, 3), false));
  const std::string_view text(reinterpret_cast<const char*>(good.data()), good.size());
  // Name, type "box2i", size, then four corners.
  const std::size_t window = text.find("dataWindow") + 11 + 6 + 4;
  for (const std::size_t corner : {std::size_t{8}, std::size_t{12}}) {
    std::vector<std::byte> bad = good;
    bad[window + corner + 2] = std::byte{0x0f};  // a million pixels
    EXPECT_THROW(parse_exr(bad, "x.exr"), Error);
    bad[window + corner + 3] = std::byte{0x3f};  // a thousand million
    EXPECT_THROW(parse_exr(bad, "x.exr"), Error);
  }
}

}  // namespace
}  // namespace sightline
