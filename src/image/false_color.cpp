#include "image/false_color.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sightline {
namespace {

// Chosen by eye at equal distances, with luma rising by about a seventh each.
const std::array<Color, 8> kStops = {Color(0.00f, 0.00f, 0.02f), Color(0.16f, 0.06f, 0.36f), Color(0.36f, 0.09f, 0.50f),
                                     Color(0.60f, 0.15f, 0.48f), Color(0.83f, 0.24f, 0.38f), Color(0.96f, 0.44f, 0.30f),
                                     Color(0.99f, 0.70f, 0.42f), Color(1.00f, 0.97f, 0.75f)};

}  // namespace

Color false_color(float t) {
  const float place = std::clamp(t, 0.0f, 1.0f) * static_cast<float>(kStops.size() - 1);
  const auto stop = std::min(static_cast<std::size_t>(place), kStops.size() - 2);
  return glm::mix(kStops[stop], kStops[stop + 1], place - static_cast<float>(stop));
}

std::vector<std::uint8_t> false_color(std::span<const float> values, float low, float high) {
  const float scale = high > low ? 1 / (high - low) : 0;
  std::vector<std::uint8_t> bytes;
  bytes.reserve(values.size() * 3);
  for (const float value : values) {
    const Color color = std::isnan(value) ? Color(0, 1, 0) : false_color((value - low) * scale);
    for (int c = 0; c < 3; ++c) bytes.push_back(static_cast<std::uint8_t>(std::lround(255 * color[c])));
  }
  return bytes;
}

}  // namespace sightline
