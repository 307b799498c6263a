#include "scene/load/pbrt/spectrum.h"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace sightline::pbrt {
namespace {

constexpr std::size_t kSamples = 41;
constexpr float kFirstNm = 380, kStepNm = 10;

struct Observer {
  float x, y, z, d65;
};
// CIE 1931 2° colour matching functions and the standard illuminant D65 every 10 nm [CIE015].
constexpr std::array<Observer, kSamples> kTable = {{
    {0.0014f, 0.0000f, 0.0065f, 49.9755f}, {0.0042f, 0.0001f, 0.0201f, 54.6482f}, {0.0143f, 0.0004f, 0.0679f, 82.7549f},
    {0.0435f, 0.0012f, 0.2074f, 91.4860f}, {0.1344f, 0.0040f, 0.6456f, 93.4318f}, {0.2839f, 0.0116f, 1.3856f, 86.6823f},
    {0.3483f, 0.0230f, 1.7471f, 104.865f}, {0.3362f, 0.0380f, 1.7721f, 117.008f}, {0.2908f, 0.0600f, 1.6692f, 117.812f},
    {0.1954f, 0.0910f, 1.2876f, 114.861f}, {0.0956f, 0.1390f, 0.8130f, 115.923f}, {0.0320f, 0.2080f, 0.4652f, 108.811f},
    {0.0049f, 0.3230f, 0.2720f, 109.354f}, {0.0093f, 0.5030f, 0.1582f, 107.802f}, {0.0633f, 0.7100f, 0.0782f, 104.790f},
    {0.1655f, 0.8620f, 0.0422f, 107.689f}, {0.2904f, 0.9540f, 0.0203f, 104.405f}, {0.4334f, 0.9950f, 0.0087f, 104.046f},
    {0.5945f, 0.9950f, 0.0039f, 100.000f}, {0.7621f, 0.9520f, 0.0021f, 96.3342f}, {0.9163f, 0.8700f, 0.0017f, 95.7880f},
    {1.0263f, 0.7570f, 0.0011f, 88.6856f}, {1.0622f, 0.6310f, 0.0008f, 90.0062f}, {1.0026f, 0.5030f, 0.0003f, 89.5991f},
    {0.8544f, 0.3810f, 0.0002f, 87.6987f}, {0.6424f, 0.2650f, 0.0000f, 83.2886f}, {0.4479f, 0.1750f, 0.0000f, 83.6992f},
    {0.2835f, 0.1070f, 0.0000f, 80.0268f}, {0.1649f, 0.0610f, 0.0000f, 80.2146f}, {0.0874f, 0.0320f, 0.0000f, 82.2778f},
    {0.0468f, 0.0170f, 0.0000f, 78.2842f}, {0.0227f, 0.0082f, 0.0000f, 69.7213f}, {0.0114f, 0.0041f, 0.0000f, 71.6091f},
    {0.0058f, 0.0021f, 0.0000f, 74.3490f}, {0.0029f, 0.0010f, 0.0000f, 61.6040f}, {0.0014f, 0.0005f, 0.0000f, 69.8856f},
    {0.0007f, 0.0003f, 0.0000f, 75.0870f}, {0.0003f, 0.0001f, 0.0000f, 63.5927f}, {0.0002f, 0.0001f, 0.0000f, 46.4182f},
    {0.0001f, 0.0000f, 0.0000f, 66.8054f}, {0.0000f, 0.0000f, 0.0000f, 63.3828f},
}};

struct Chromaticity {
  double x, y;
};
using Mat3d = glm::dmat3;

Vec3d xyz_of(const Chromaticity& c) { return {c.x / c.y, 1.0, (1 - c.x - c.y) / c.y}; }

/// Matrix to CIE XYZ of a space given by primaries and white.
Mat3d xyz_from_rgb(const Chromaticity& r, const Chromaticity& g, const Chromaticity& b, const Chromaticity& white) {
  const auto column = [](const Chromaticity& c) { return Vec3d(c.x, c.y, 1 - c.x - c.y); };
  const Mat3d primaries(column(r), column(g), column(b));
  const Vec3d amounts = glm::inverse(primaries) * xyz_of(white);
  return {primaries[0] * amounts.x, primaries[1] * amounts.y, primaries[2] * amounts.z};
}

constexpr Chromaticity kD65 = {0.3127, 0.3290};

Mat3d xyz_from_working() { return xyz_from_rgb({0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, kD65); }

/// Bradford chromatic adaptation.
Mat3d adapt(const Chromaticity& from, const Chromaticity& to) {
  const Mat3d cone = glm::transpose(Mat3d(0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296));
  const Vec3d ratio = (cone * xyz_of(to)) / (cone * xyz_of(from));
  return glm::inverse(cone) * Mat3d(ratio.x, 0, 0, 0, ratio.y, 0, 0, 0, ratio.z) * cone;
}

/// Working-space colour of the XYZ that the sum over wavelengths of value times observer gives.
template <class Value>
Vec3d integrate(const Value& value) {
  Vec3d xyz(0);
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double v = value(kFirstNm + kStepNm * static_cast<float>(i), kTable[i]);
    xyz += v * Vec3d(kTable[i].x, kTable[i].y, kTable[i].z);
  }
  return glm::inverse(xyz_from_working()) * xyz;
}

Vec3d weighted_by_d65(const auto& value) {
  const Vec3d white = integrate([](float, const Observer& o) { return static_cast<double>(o.d65); });
  return integrate([&](float nm, const Observer& o) { return static_cast<double>(value(nm)) * static_cast<double>(o.d65); }) / white;
}

}  // namespace

float Spectrum::at(float wavelength_nm) const {
  if (samples.empty()) return 0;
  const auto after = std::lower_bound(samples.begin(), samples.end(), wavelength_nm, [](const auto& s, float nm) { return s.first < nm; });
  if (after == samples.begin()) return samples.front().second;
  if (after == samples.end()) return samples.back().second;
  const auto before = after - 1;
  const float t = (wavelength_nm - before->first) / (after->first - before->first);
  return (1 - t) * before->second + t * after->second;
}

std::optional<Spectrum> spectrum_from_pairs(std::span<const float> pairs) {
  if (pairs.empty() || pairs.size() % 2 != 0) return std::nullopt;
  Spectrum spectrum;
  for (std::size_t i = 0; i < pairs.size(); i += 2) {
    if (!std::isfinite(pairs[i]) || !std::isfinite(pairs[i + 1])) return std::nullopt;
    if (i > 0 && !(pairs[i] > pairs[i - 2])) return std::nullopt;
    spectrum.samples.emplace_back(pairs[i], pairs[i + 1]);
  }
  return spectrum;
}

std::optional<Spectrum> spectrum_from_text(std::string_view text) {
  std::vector<float> numbers;
  const char *at = text.data(), *const end = text.data() + text.size();
  while (at != end) {
    if (*at == '#') {
      at = std::find(at, end, '\n');
    } else if (*at == ' ' || *at == '\t' || *at == '\r' || *at == '\n' || *at == ',') {
      ++at;
    } else {
      float value = 0;
      const auto [stop, status] = fast_float::from_chars(at, end, value);
      if (status != std::errc{}) return std::nullopt;
      numbers.push_back(value);
      at = stop;
    }
  }
  return spectrum_from_pairs(numbers);
}

Spectrum blackbody_spectrum(float temperature_k) {
  Spectrum spectrum;
  spectrum.samples.reserve(kSamples);
  constexpr double kSecondRadiationConstant = 1.438776877e-2;  // h c / k, m K
  for (std::size_t i = 0; i < kSamples; ++i) {
    const float nm = kFirstNm + kStepNm * static_cast<float>(i);
    // Relative to 560 nm, so that nothing overflows.
    const double exponent = kSecondRadiationConstant / (static_cast<double>(nm) * 1e-9 * temperature_k);
    const double at_560 = kSecondRadiationConstant / (560e-9 * temperature_k);
    const double ratio = std::pow(560.0 / nm, 5) * std::exp(at_560 - exponent) * -std::expm1(-at_560) / -std::expm1(-exponent);
    spectrum.samples.emplace_back(nm, static_cast<float>(ratio));
  }
  return spectrum;
}

std::vector<std::pair<float, float>> daylight_d65_samples() {
  std::vector<std::pair<float, float>> samples;
  samples.reserve(kSamples);
  for (std::size_t i = 0; i < kSamples; ++i) samples.emplace_back(kFirstNm + kStepNm * static_cast<float>(i), kTable[i].d65 / 100);
  return samples;
}

Color reflectance_color(const Spectrum& spectrum) {
  return Color(weighted_by_d65([&](float nm) { return spectrum.at(nm); }));
}

Color emission_color(const Spectrum& spectrum) {
  const Vec3d rgb = integrate([&](float nm, const Observer&) { return static_cast<double>(spectrum.at(nm)); });
  const double y = 0.2126 * rgb.x + 0.7152 * rgb.y + 0.0722 * rgb.z;
  if (!(y > 0) || !std::isfinite(y)) return Color(0);
  // What lies outside the gamut is cut; the luminance stays.
  const Vec3d inside = glm::max(rgb / y, Vec3d(0));
  return Color(inside / (0.2126 * inside.x + 0.7152 * inside.y + 0.0722 * inside.z));
}

float mean_value(const Spectrum& spectrum) {
  double sum = 0, weight = 0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double w = static_cast<double>(kTable[i].y) * static_cast<double>(kTable[i].d65);
    sum += w * static_cast<double>(spectrum.at(kFirstNm + kStepNm * static_cast<float>(i)));
    weight += w;
  }
  return static_cast<float>(sum / weight);
}

ConductorColors conductor_colors(const Spectrum& eta, const Spectrum& k) {
  const Vec3d reflectance = weighted_by_d65([&](float nm) {
    const float n = eta.at(nm), kappa = k.at(nm);
    return ((n - 1) * (n - 1) + kappa * kappa) / ((n + 1) * (n + 1) + kappa * kappa);
  });
  const Vec3d mean_eta = weighted_by_d65([&](float nm) { return eta.at(nm); });
  ConductorColors result;
  for (int c = 0; c < 3; ++c) {
    // The index is the channel's mean; k follows from the reflectance at normal incidence, F = ((n-1)² + k²) / ((n+1)² + k²).
    const double f = std::clamp(reflectance[c], 0.0, 0.9999);
    double n = std::max(mean_eta[c], 0.01);
    double k_squared = (f * (n + 1) * (n + 1) - (n - 1) * (n - 1)) / (1 - f);
    if (k_squared < 0) {  // no k reflects that little: the index alone decides
      n = (1 + std::sqrt(f)) / (1 - std::sqrt(f));
      k_squared = 0;
    }
    result.eta[c] = static_cast<float>(n);
    result.k[c] = static_cast<float>(std::sqrt(k_squared));
  }
  return result;
}

std::optional<ColorSpace> parse_color_space(std::string_view name) {
  if (name == "srgb") return ColorSpace::srgb;
  if (name == "dci-p3") return ColorSpace::dci_p3;
  if (name == "rec2020") return ColorSpace::rec2020;
  if (name == "aces2065-1") return ColorSpace::aces2065_1;
  return std::nullopt;
}

Color to_working_space(ColorSpace space, const Color& color) {
  Mat3d xyz(1);
  switch (space) {
    case ColorSpace::srgb:
      return color;
    case ColorSpace::dci_p3:
      xyz = xyz_from_rgb({0.680, 0.320}, {0.265, 0.690}, {0.150, 0.060}, kD65);
      break;
    case ColorSpace::rec2020:
      xyz = xyz_from_rgb({0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}, kD65);
      break;
    case ColorSpace::aces2065_1: {
      constexpr Chromaticity kAcesWhite = {0.32168, 0.33767};
      xyz = adapt(kAcesWhite, kD65) * xyz_from_rgb({0.7347, 0.2653}, {0.0, 1.0}, {0.0001, -0.0770}, kAcesWhite);
      break;
    }
  }
  return Color(glm::inverse(xyz_from_working()) * (xyz * Vec3d(color)));
}

}  // namespace sightline::pbrt
