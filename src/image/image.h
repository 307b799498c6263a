// Pixel containers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "base/math/vec.h"

namespace sightline {

/// Interleaved pixels, row 0 at the top. Values are linear unless the holder knows better (8-bit colour is usually sRGB).
struct Image {
  using Bytes = std::vector<std::uint8_t>;
  using Words = std::vector<std::uint16_t>;  ///< 16-bit unsigned normalised
  using Floats = std::vector<float>;

  int width = 0, height = 0, channels = 0;
  std::variant<Bytes, Words, Floats> data;

  std::size_t pixel_count() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
  bool is_float() const { return std::holds_alternative<Floats>(data); }
  std::size_t size_bytes() const;
  /// Stored value: 0..1 for integers, as is for floats.
  float value(int x, int y, int channel) const;
};

/// Linear RGB picture, row 0 at the top.
struct ColorImage {
  int width = 0, height = 0;
  std::vector<Color> pixels;

  ColorImage() = default;
  ColorImage(int w, int h, Color fill = Color(0))
      : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), fill) {}
  Color& at(int x, int y) { return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)]; }
  const Color& at(int x, int y) const {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
};

/// A named float channel of a layered picture ("R", "albedo.G", "depth.Z").
struct Channel {
  std::string name;
  bool half = false;  ///< stored as 16-bit float in EXR
  std::vector<float> values;
};

/// Several channels of one size with text metadata, as an EXR file holds them.
struct LayeredImage {
  int width = 0, height = 0;
  std::vector<Channel> channels;
  std::vector<std::pair<std::string, std::string>> metadata;

  const Channel* find(std::string_view name) const;
};

/// The colour of the picture (channels R G B, or Y); throws Error{input} if it has none.
ColorImage color_of(const LayeredImage& image);

}  // namespace sightline
