// From linear radiance to 8-bit sRGB.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "image/image.h"

namespace sightline {

enum class ToneMap { srgb, reinhard, aces, filmic };

/// Linear value to the sRGB curve [IEC 61966-2-1], and back.
float srgb_from_linear(float value);
float linear_from_srgb(float value);
/// The curve alone, a channel: linear light to linear display light, 0..1. NaN and negative values become 0.
float tone_curve(float linear, ToneMap curve);
/// Tone-mapped, sRGB-encoded 0..1 colour after `exposure_ev` stops.
Color tone_map(const Color& linear, ToneMap curve, float exposure_ev);
/// The whole picture as interleaved 8-bit RGB, rounded.
std::vector<std::uint8_t> to_srgb8(const ColorImage& image, ToneMap curve = ToneMap::srgb, float exposure_ev = 0);
ToneMap tone_map_from_name(std::string_view name);  ///< throws Error{usage}

}  // namespace sightline
