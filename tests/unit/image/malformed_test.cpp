// Cut, garbled and hostile files: each ends in a picture or in one Error{input} that names the file, and takes bounded memory.
#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "base/core/context.h"
#include "base/core/error.h"
#include "image/io/image_io.h"
#include "unit/image/test_pictures.h"

namespace sightline {
namespace {

struct Sample {
  std::string name;
  std::vector<std::byte> bytes;
  bool cut_is_error = true;  ///< every shorter file lacks something
};

std::vector<Sample> samples() {
  const ColorImage picture = test::random_picture(40, 24, 11);
  const std::vector<std::uint8_t> pixels = test::random_bytes(40 * 24 * 3, 12);
  std::vector<Sample> list = {{"a.hdr", encode_hdr(picture)},
                              {"a.pfm", encode_pfm(picture)},
                              {"a.png", encode_png(40, 24, 3, pixels)},
                              {"a.jpg", encode_jpeg(40, 24, pixels), false}};
  for (const ExrCompression compression :
       {ExrCompression::none, ExrCompression::rle, ExrCompression::zip, ExrCompression::piz, ExrCompression::dwab})
    list.push_back({"a.exr", encode_exr(test::layers_of(picture, true), {compression})});
  Sample tga{"a.tga", {}};
  test::append(tga.bytes, {0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 40, 0, 24, 0, 24, 0});
  for (const std::uint8_t value : pixels) tga.bytes.push_back(static_cast<std::byte>(value));
  list.push_back(tga);
  Sample bmp{"a.bmp", test::bytes_of("BM")};
  test::append(bmp.bytes, {0, 0, 0, 0, 0, 0, 0, 0, 54, 0, 0, 0, 40, 0, 0, 0, 40, 0, 0, 0, 24, 0, 0, 0, 1, 0, 24, 0});
  test::append(bmp.bytes, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  for (const std::uint8_t value : pixels) bmp.bytes.push_back(static_cast<std::byte>(value));
  list.push_back(bmp);
  return list;
}

/// True if it reads; fails the test on an error of another kind.
bool reads(std::span<const std::byte> bytes, const std::string& name) {
  try {
    const Image image = parse_image(bytes, name);
    EXPECT_GT(image.width, 0);
    EXPECT_EQ(image.size_bytes() % image.pixel_count(), 0u);
    return true;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input) << error.what();
    EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    return false;
  }
}

TEST(Malformed, EveryCutFileIsAnError) {
  for (const Sample& sample : samples()) {
    ASSERT_TRUE(reads(sample.bytes, sample.name)) << sample.name;
    const std::size_t step = std::max<std::size_t>(1, sample.bytes.size() / 300);
    for (std::size_t size = 0; size < sample.bytes.size(); size += step) {
      const bool readable = reads(std::span(sample.bytes).first(size), sample.name);
      if (sample.cut_is_error) {
        EXPECT_FALSE(readable) << sample.name << " cut to " << size;
      }
    }
    EXPECT_FALSE(reads(std::span(sample.bytes).first(sample.bytes.size() / 2), sample.name)) << sample.name;
  }
}

TEST(Malformed, FlippedBitsNeverDoHarm) {
  std::mt19937 random(13);
  for (const Sample& sample : samples()) {
    for (int round = 0; round < 300; ++round) {
      std::vector<std::byte> bytes = sample.bytes;
      // The header is where the harm is, so half of the flips go there.
      const std::size_t reach = round % 2 == 0 ? std::min<std::size_t>(bytes.size(), 400) : bytes.size();
      for (unsigned flips = 1 + random() % 4; flips > 0; --flips) bytes[random() % reach] ^= static_cast<std::byte>(1 << random() % 8);
      reads(bytes, sample.name);
    }
  }
  EXPECT_LT(peak_resident_bytes(), std::uint64_t{1} << 30);
}

TEST(Malformed, WhatIsNoPictureIsAnError) {
  EXPECT_FALSE(reads({}, "empty"));
  EXPECT_FALSE(reads(test::bytes_of("This is a text, not a picture."), "text"));
}

TEST(Malformed, RealHostileFilesEndInAnErrorOrAPicture) {
  const auto data = test::shared_data();
  if (!data) return;
  for (const std::string folder : {"exr-openexr-damaged", "exr-tinyexr", "exr-openexr-tests", "exr-oiio", "hdr", "textures-oiio"}) {
    if (!std::filesystem::exists(*data / "malformed" / folder)) continue;
    for (const auto& entry : std::filesystem::directory_iterator(*data / "malformed" / folder)) {
      const std::string name = entry.path().string();
      reads(read_file(name), name);
      try {
        read_layered_image(name);
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input) << error.what();
      }
    }
  }
}

TEST(Malformed, RealSoundFilesRead) {
  const auto data = test::shared_data();
  if (!data) return;
  for (const std::string folder : {"exr-variants", "environments"}) {
    if (!std::filesystem::exists(*data / folder)) continue;
    for (const auto& entry : std::filesystem::directory_iterator(*data / folder)) {
      // Its channels are subsampled, which is refused.
      if (entry.path().filename() == "comp_b44.exr") continue;
      EXPECT_TRUE(reads(read_file(entry.path()), entry.path().string())) << entry.path();
    }
  }
}

}  // namespace
}  // namespace sightline
