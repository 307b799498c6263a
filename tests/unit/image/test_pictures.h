// Small pictures and byte helpers that the tests of this folder share.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <random>
#include <span>
#include <string_view>
#include <vector>

#include "image/image.h"

namespace sightline::test {

inline std::vector<std::byte> bytes_of(std::string_view text) {
  const auto* data = reinterpret_cast<const std::byte*>(text.data());
  return {data, data + text.size()};
}
inline void append(std::vector<std::byte>& bytes, std::initializer_list<int> values) {
  for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
}

/// Random colours over many magnitudes, with runs of equal pixels, so that every branch of a run-length encoder is taken.
inline ColorImage random_picture(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> mantissa(0, 1), exponent(-12, 12);
  ColorImage image(width, height);
  Color last(0.25f);
  for (Color& pixel : image.pixels) {
    const unsigned kind = random() % 4;
    if (kind == 0) last = Color(mantissa(random), mantissa(random), mantissa(random)) * std::exp2(exponent(random));
    if (kind == 1) last = Color(0);
    pixel = last;
  }
  return image;
}

inline std::vector<std::uint8_t> random_bytes(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<std::uint8_t> bytes(count);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random() % 4 == 0 ? random() : 77);
  return bytes;
}

inline LayeredImage layers_of(const ColorImage& image, bool half) {
  LayeredImage layers{image.width, image.height, {{"R", half, {}}, {"G", half, {}}, {"B", half, {}}}, {}};
  for (const Color& pixel : image.pixels) {
    for (int c = 0; c < 3; ++c) layers.channels[static_cast<std::size_t>(c)].values.push_back(pixel[c]);
  }
  return layers;
}

/// Real files, where a user has them.
inline std::optional<std::filesystem::path> shared_data() {
  const char* folder = std::getenv("SIGHTLINE_DATA");
  return folder && *folder ? std::optional<std::filesystem::path>(folder) : std::nullopt;
}

}  // namespace sightline::test
