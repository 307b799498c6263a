#include "report/packed_image.h"

#include <half.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/core/error.h"
#include "report/html.h"

namespace sightline {
namespace {

constexpr float kLargestHalf = 65504;

std::uint16_t half_bits(float value) {
  if (std::isfinite(value)) value = std::clamp(value, -kLargestHalf, kLargestHalf);
  return imath_float_to_half(value);
}

std::vector<std::byte> deflate_bytes(const std::vector<std::uint8_t>& plain) {
  uLongf size = compressBound(static_cast<uLong>(plain.size()));
  std::vector<std::byte> packed(size);
  if (compress2(reinterpret_cast<Bytef*>(packed.data()), &size, plain.data(), static_cast<uLong>(plain.size()), 6) != Z_OK)
    throw resource_error("a picture of the report could not be compressed");
  packed.resize(size);
  return packed;
}

}  // namespace

PackedImage pack_image(const ColorImage& image) {
  const std::size_t count = image.pixels.size(), width = static_cast<std::size_t>(image.width);
  std::vector<std::uint8_t> planes(6 * count);
  double sum = 0;
  std::size_t finite_count = 0;
  for (const Color& pixel : image.pixels) {
    const Vec3d rounded(imath_half_to_float(half_bits(pixel.x)), imath_half_to_float(half_bits(pixel.y)),
                        imath_half_to_float(half_bits(pixel.z)));
    const double y = 0.2126 * rounded.x + 0.7152 * rounded.y + 0.0722 * rounded.z;
    if (!std::isfinite(y)) continue;
    sum += y;
    ++finite_count;
  }
  for (int channel = 0; channel < 3; ++channel) {
    std::uint8_t* high = planes.data() + 2 * static_cast<std::size_t>(channel) * count;
    std::uint8_t* low = high + count;
    for (std::size_t i = 0; i < count; ++i) {
      // The neighbour to the left predicts; at the left border the one above.
      const std::size_t neighbour = i % width != 0 ? i - 1 : i - width;
      const std::uint16_t own = half_bits(image.pixels[i][channel]);
      const std::uint16_t predicted = i == 0 ? std::uint16_t{0} : half_bits(image.pixels[neighbour][channel]);
      const auto delta = static_cast<std::uint16_t>(own - predicted);
      high[i] = static_cast<std::uint8_t>(delta >> 8);
      low[i] = static_cast<std::uint8_t>(delta & 255);
    }
  }
  return {image.width, image.height, base64(deflate_bytes(planes)), finite_count ? sum / static_cast<double>(finite_count) : 0.0};
}

}  // namespace sightline
