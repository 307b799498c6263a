#include "image/image.h"

#include <algorithm>
#include <type_traits>

#include "base/core/error.h"

namespace sightline {

std::size_t Image::size_bytes() const {
  return std::visit([](const auto& values) { return values.size() * sizeof(values[0]); }, data);
}

float Image::value(int x, int y, int channel) const {
  const std::size_t pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  const std::size_t index = pixel * static_cast<std::size_t>(channels) + static_cast<std::size_t>(channel);
  return std::visit(
      [index](const auto& values) -> float {
        using Value = typename std::decay_t<decltype(values)>::value_type;
        if constexpr (std::is_same_v<Value, std::uint8_t>) return static_cast<float>(values[index]) / 255.0f;
        if constexpr (std::is_same_v<Value, std::uint16_t>) return static_cast<float>(values[index]) / 65535.0f;
        return static_cast<float>(values[index]);
      },
      data);
}

const Channel* LayeredImage::find(std::string_view name) const {
  const auto found = std::find_if(channels.begin(), channels.end(), [name](const Channel& channel) { return channel.name == name; });
  return found == channels.end() ? nullptr : &*found;
}

ColorImage color_of(const LayeredImage& image) {
  const Channel *r = image.find("R"), *g = image.find("G"), *b = image.find("B");
  if (!r || !g || !b) {
    r = g = b = image.find("Y");
    if (!r) throw input_error("the picture has no colour: neither channels R, G, B nor Y");
  }
  ColorImage result(image.width, image.height);
  if (std::min({r->values.size(), g->values.size(), b->values.size()}) < result.pixels.size())
    throw input_error("a colour channel has fewer values than the picture has pixels");
  for (std::size_t i = 0; i < result.pixels.size(); ++i) result.pixels[i] = Color(r->values[i], g->values[i], b->values[i]);
  return result;
}

}  // namespace sightline
