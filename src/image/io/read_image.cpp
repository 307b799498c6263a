// Which reader a file belongs to, and pictures as Image or LayeredImage.
#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "base/core/error.h"
#include "image/io/formats.h"
#include "image/io/image_io.h"

namespace sightline {
namespace {

using Bytes = std::span<const std::byte>;

/// The colour of an EXR file: R G B (A), else Y (A), else its only channel. Of R, G and B some may be missing: they are 0, as in OpenEXR.
Image color_from_layers(const LayeredImage& layers) {
  std::vector<const Channel*> chosen;
  const Channel *r = layers.find("R"), *g = layers.find("G"), *b = layers.find("B"), *y = layers.find("Y"), *a = layers.find("A");
  if (r || g || b) {
    chosen = {r, g, b};
    if (a) chosen.push_back(a);
  } else if (y && a) {
    chosen = {y, y, y, a};
  } else if (y) {
    chosen = {y};
  } else if (layers.channels.size() == 1) {
    chosen = {&layers.channels.front()};
  } else {
    std::string names;
    for (const Channel& channel : layers.channels) {
      if (names.size() > 200) {
        names += ", ...";
        break;
      }
      names += (names.empty() ? "" : ", ") + channel.name;
    }
    throw input_error("no colour channels R, G, B or Y among " + names);
  }

  Image image{layers.width, layers.height, static_cast<int>(chosen.size()), {}};
  Image::Floats values(image.pixel_count() * chosen.size());
  for (std::size_t c = 0; c < chosen.size(); ++c) {
    if (!chosen[c]) continue;
    const std::vector<float>& source = chosen[c]->values;
    for (std::size_t i = 0; i < source.size(); ++i) values[i * chosen.size() + c] = source[i];
  }
  image.data = std::move(values);
  return image;
}

LayeredImage layers_from_image(const Image& image) {
  static constexpr std::array<std::string_view, 4> names = {"R", "G", "B", "A"};
  LayeredImage layers{image.width, image.height, {}, {}};
  for (int c = 0; c < image.channels; ++c) {
    Channel channel{image.channels == 1 ? "Y" : std::string(names[static_cast<std::size_t>(c)]), false, {}};
    channel.values.reserve(image.pixel_count());
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) channel.values.push_back(image.value(x, y, c));
    }
    layers.channels.push_back(std::move(channel));
  }
  return layers;
}

Image parse_known(Bytes bytes) {
  if (bytes.empty()) throw input_error("the file is empty");
  if (looks_like_exr(bytes)) return color_from_layers(parse_exr_layers(bytes));
  if (looks_like_hdr(bytes)) return parse_hdr(bytes);
  if (looks_like_pfm(bytes)) return parse_pfm(bytes);
  if (looks_like_png(bytes)) return parse_png(bytes);
  if (looks_like_jpeg(bytes)) return parse_jpeg(bytes);
  if (looks_like_bmp(bytes)) return parse_bmp(bytes);
  if (looks_like_tga(bytes)) return parse_tga(bytes);
  throw input_error("not a picture in a known format").remedy("EXR, HDR, PFM, PNG, JPEG, TGA and BMP are read");
}

/// Calls `parse()` and puts the file's name on its errors.
template <class Parse>
auto named(const std::string& name, Parse&& parse) {
  try {
    return parse();
  } catch (Error& error) {
    error.at(name);
    throw;
  }
}

}  // namespace

void check_picture_size(std::int64_t width, std::int64_t height, std::size_t bytes_per_pixel, std::size_t encoded_bytes, double expansion) {
  constexpr std::int64_t largest_side = std::int64_t{1} << 20;
  if (width <= 0 || height <= 0) throw input_error(fmt::format("a picture of {} x {} pixels is impossible", width, height));
  if (width > largest_side || height > largest_side)
    throw input_error(fmt::format("a picture of {} x {} pixels is too large: {} a side is the limit", width, height, largest_side));
  const double decoded = static_cast<double>(width) * static_cast<double>(height) * static_cast<double>(bytes_per_pixel);
  // A few rows are always granted, so that headers and rounding need no thought.
  if (decoded > expansion * static_cast<double>(encoded_bytes) + 4096)
    throw input_error(
        fmt::format("a picture of {} x {} pixels, {:.0f} bytes, cannot come from {} bytes of data", width, height, decoded, encoded_bytes))
        .remedy("the file is cut short or damaged");
}

Image parse_image(Bytes bytes, const std::string& name) {
  return named(name, [&] { return parse_known(bytes); });
}

Image read_image(const std::filesystem::path& path) { return parse_image(read_file(path), path.string()); }

LayeredImage parse_exr(Bytes bytes, const std::string& name) {
  return named(name, [&] { return parse_exr_layers(bytes); });
}

LayeredImage read_layered_image(const std::filesystem::path& path) {
  const std::vector<std::byte> bytes = read_file(path);
  if (looks_like_exr(bytes)) return parse_exr(bytes, path.string());
  return layers_from_image(parse_image(bytes, path.string()));
}

}  // namespace sightline
