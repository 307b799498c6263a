#include "image/tone_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "base/core/error.h"

namespace sightline {
namespace {

struct NamedCurve {
  std::string_view name;
  ToneMap curve;
};
constexpr std::array kCurves = {NamedCurve{"srgb", ToneMap::srgb}, NamedCurve{"reinhard", ToneMap::reinhard},
                                NamedCurve{"aces", ToneMap::aces}, NamedCurve{"filmic", ToneMap::filmic}};

/// x / (1 + x) a channel: the curve of [Reinhard2002, Eq. 3] without its key, which is the exposure's business here.
float reinhard(float x) { return std::isinf(x) ? 1.0f : x / (1.0f + x); }

/// The rational fit to the ACES reference and output transform for SDR displays of [Narkowicz2015]. Beyond 10^4 it has long reached 1,
/// and x² would overflow in the end.
float aces(float x) {
  x = std::min(x, 1e4f);
  return x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f);
}

/// The shoulder–line–toe curve of [Hable2010]: A shoulder strength, B and C linear strength and angle, D toe strength, E/F toe angle.
float filmic_curve(float x) {
  constexpr float a = 0.15f, b = 0.50f, c = 0.10f, d = 0.20f, e = 0.02f, f = 0.30f;
  return (x * (a * x + c * b) + d * e) / (x * (a * x + b) + d * f) - e / f;
}

/// Hable's curve with his exposure bias of 2, scaled so that the linear white point 11.2 becomes 1.
float filmic(float x) {
  constexpr float exposure_bias = 2.0f, white = 11.2f;
  return filmic_curve(std::min(exposure_bias * x, 1e4f)) / filmic_curve(white);
}

/// NaN and negative values become 0: a display cannot show them, and a NaN must not turn into an arbitrary byte.
float displayable(float x) { return x > 0 ? x : 0.0f; }

float apply(float x, ToneMap curve) {
  switch (curve) {
    case ToneMap::srgb:
      return x;
    case ToneMap::reinhard:
      return reinhard(x);
    case ToneMap::aces:
      return aces(x);
    case ToneMap::filmic:
      return filmic(x);
  }
  return x;
}

}  // namespace

float srgb_from_linear(float value) { return value <= 0.0031308f ? 12.92f * value : 1.055f * std::pow(value, 1.0f / 2.4f) - 0.055f; }

float linear_from_srgb(float value) { return value <= 0.04045f ? value / 12.92f : std::pow((value + 0.055f) / 1.055f, 2.4f); }

float tone_curve(float linear, ToneMap curve) { return std::clamp(apply(displayable(linear), curve), 0.0f, 1.0f); }

Color tone_map(const Color& linear, ToneMap curve, float exposure_ev) {
  const float scale = std::exp2(exposure_ev);
  Color result;
  for (int c = 0; c < 3; ++c) result[c] = srgb_from_linear(tone_curve(linear[c] * scale, curve));
  return result;
}

std::vector<std::uint8_t> to_srgb8(const ColorImage& image, ToneMap curve, float exposure_ev) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(image.pixels.size() * 3);
  for (const Color& pixel : image.pixels) {
    const Color encoded = tone_map(pixel, curve, exposure_ev);
    for (int c = 0; c < 3; ++c) bytes.push_back(static_cast<std::uint8_t>(std::lround(255.0f * encoded[c])));
  }
  return bytes;
}

ToneMap tone_map_from_name(std::string_view name) {
  std::string known;
  for (const NamedCurve& entry : kCurves) {
    if (entry.name == name) return entry.curve;
    known += known.empty() ? "" : ", ";
    known += entry.name;
  }
  throw usage_error("unknown tone map '" + std::string(name) + "'").remedy("known are " + known);
}

}  // namespace sightline
