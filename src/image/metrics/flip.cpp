// LDR-FLIP [Andersson2020]: the difference that an observer sees who flips between two pictures, mean over pixels. A pixel's error is
//   ΔE = ΔEc^(1 − ΔEf)
// with the colour difference ΔEc (HyAB in Hunt-adjusted L*a*b*, after the eye's contrast sensitivity has blurred both pictures) and the
// feature difference ΔEf (edges and points of the achromatic channel). Taken after exposure and clipping to display range.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "image/metrics/convolve.h"
#include "image/metrics/flip_core.h"
#include "image/metrics/metric_functions.h"
#include "image/metrics/pixels.h"
#include "image/tone_map.h"

namespace sightline {
namespace {

constexpr float kColorExponent = 0.7f, kFeatureExponent = 0.5f;  // qc, qf
constexpr float kBreak = 0.4f, kBreakValue = 0.95f;              // pc, pt
constexpr double kFeatureWidthDegrees = 0.082;                   // w

/// Rec.709 to XYZ relative to the white point D65, so that white is (1, 1, 1).
Color relative_xyz(const Color& c) {
  // The fractions are exact for Rec.709's primaries; the last digits reach the values of FLIP.
  static const Mat3 xyz_from_rgb =
      glm::transpose(Mat3(10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794, 2613072.0 / 12288897, 8788810.0 / 12288897,
                          887015.0 / 12288897, 1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382));
  static const Color white = xyz_from_rgb * Color(1);
  return (xyz_from_rgb * c) / white;
}

Color rgb_from_relative_xyz(const Color& xyz) {
  static const Mat3 inverse = glm::inverse(Mat3(relative_xyz({1, 0, 0}), relative_xyz({0, 1, 0}), relative_xyz({0, 0, 1})));
  return inverse * xyz;
}

/// The linear opponent space in which the eye's blur is applied.
Color ycxcz_from_rgb(const Color& rgb) {
  const Color xyz = relative_xyz(rgb);
  return {116 * xyz.y - 16, 500 * (xyz.x - xyz.y), 200 * (xyz.y - xyz.z)};
}
Color rgb_from_ycxcz(const Color& c) {
  const float y = (c.x + 16) / 116;
  return rgb_from_relative_xyz({c.y / 500 + y, y, y - c.z / 200});
}

/// CIE L*a*b* with a* and b* scaled by L*/100: colours of dark things differ less to the eye (Hunt's effect).
Color hunt_lab_from_rgb(const Color& rgb) {
  const auto root = [](float t) {
    constexpr float delta = 6.0f / 29;
    return t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0f / 29;
  };
  const Color xyz = relative_xyz(rgb);
  const float x = root(xyz.x), y = root(xyz.y), z = root(xyz.z);
  const float lightness = 116 * y - 16, scale = 0.01f * lightness;
  return {lightness, scale * 500 * (x - y), scale * 200 * (y - z)};
}

float hyab(const Color& a, const Color& b) { return std::fabs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z); }

/// Spreads differences over 0..1: the lower 40 % of the range, where almost all of them lie, take 95 % of it.
float redistributed(float difference) {
  static const float largest = std::pow(hyab(hunt_lab_from_rgb({0, 1, 0}), hunt_lab_from_rgb({0, 0, 1})), kColorExponent);
  const float error = std::pow(difference, kColorExponent), limit = kBreak * largest;
  if (error < limit) return kBreakValue / limit * error;
  return kBreakValue + (error - limit) / (largest - limit) * (1 - kBreakValue);
}

/// A sum of Gaussians a sqrt(π/b) exp(−π² x² / b), x in degrees: the contrast sensitivity of one opponent channel.
struct Sensitivity {
  std::array<double, 2> a, b;
};
constexpr std::array<Sensitivity, 3> kSensitivities = {{{{1, 0}, {0.0047, 1e-5}}, {{1, 0}, {0.0053, 1e-5}}, {{34.1, 13.5}, {0.04, 0.025}}}};

/// Each Gaussian is a product of one in x and one in y, so a channel takes two one-dimensional passes a Gaussian.
Plane blurred(const Plane& channel, const Sensitivity& sensitivity, double pixels_per_degree) {
  constexpr double pi = std::numbers::pi, widest = 0.04;
  const int radius = static_cast<int>(std::ceil(3 * std::sqrt(widest / (2 * pi * pi)) * pixels_per_degree));
  Plane result(channel.width, channel.height);
  double norm = 0;
  for (std::size_t g = 0; g < 2; ++g) {
    if (sensitivity.a[g] == 0) continue;
    const double sigma = std::sqrt(sensitivity.b[g] / (2 * pi * pi)) * pixels_per_degree;
    const std::vector<float> kernel = gaussian_kernel(sigma, radius);
    double kernel_sum = 0;
    for (const float value : kernel) kernel_sum += value;
    const double weight = sensitivity.a[g] * std::sqrt(pi / sensitivity.b[g]);
    norm += weight * kernel_sum * kernel_sum;
    const Plane part = filter_columns(filter_rows(channel, kernel, Border::clamp), kernel, Border::clamp);
    for (std::size_t i = 0; i < part.values.size(); ++i) result.values[i] += static_cast<float>(weight) * part.values[i];
  }
  for (float& value : result.values) value /= static_cast<float>(norm);
  return result;
}

/// Size of edges and points in the achromatic channel: first and second derivatives of a Gaussian.
struct Features {
  std::vector<float> edges, points;
};

/// Positive weights are made to sum to 1 and negative ones to −1, as in the paper; the 2D kernels are products, so this holds for them too.
void normalize_signs(std::vector<float>& kernel) {
  double positive = 0, negative = 0;
  for (const float value : kernel) (value > 0 ? positive : negative) += value;
  for (float& value : kernel) value = static_cast<float>(value / (value > 0 ? positive : negative == 0 ? 1 : -negative));
}

Features find_features(const Plane& achromatic, double pixels_per_degree) {
  const double sigma = 0.5 * kFeatureWidthDegrees * pixels_per_degree;
  const int radius = static_cast<int>(std::ceil(3 * sigma));
  std::vector<float> smooth = gaussian_kernel(sigma, radius), slope = smooth, curvature = smooth;
  for (int x = -radius; x <= radius; ++x) {
    const auto k = static_cast<std::size_t>(std::ptrdiff_t{x} + radius);
    slope[k] *= static_cast<float>(-x);
    curvature[k] *= static_cast<float>(x * x / (sigma * sigma) - 1);
  }
  for (std::vector<float>* kernel : {&smooth, &slope, &curvature}) normalize_signs(*kernel);

  const Plane rows_smooth = filter_rows(achromatic, smooth, Border::clamp);
  const auto magnitude = [&](const std::vector<float>& kernel) {
    const Plane along_x = filter_columns(filter_rows(achromatic, kernel, Border::clamp), smooth, Border::clamp);
    Plane along_y = filter_columns(rows_smooth, kernel, Border::clamp);
    for (std::size_t i = 0; i < along_y.values.size(); ++i)
      along_y.values[i] = std::sqrt(along_x.values[i] * along_x.values[i] + along_y.values[i] * along_y.values[i]);
    return std::move(along_y.values);
  };
  return {magnitude(slope), magnitude(curvature)};
}

/// One picture's side of the comparison.
struct Seen {
  std::vector<Color> lab;
  Features features;
};

Seen see(const ColorImage& picture, double pixels_per_degree) {
  std::array<Plane, 3> opponent = {Plane(picture.width, picture.height), Plane(picture.width, picture.height),
                                   Plane(picture.width, picture.height)};
  Plane achromatic(picture.width, picture.height);
  for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
    const Color c = ycxcz_from_rgb(picture.pixels[i]);
    for (int k = 0; k < 3; ++k) opponent[static_cast<std::size_t>(k)].values[i] = c[k];
    achromatic.values[i] = (c.x + 16) / 116;
  }
  Seen seen;
  seen.features = find_features(achromatic, pixels_per_degree);
  for (std::size_t k = 0; k < 3; ++k) opponent[k] = blurred(opponent[k], kSensitivities[k], pixels_per_degree);
  seen.lab.reserve(picture.pixels.size());
  for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
    const Color rgb = rgb_from_ycxcz({opponent[0].values[i], opponent[1].values[i], opponent[2].values[i]});
    seen.lab.push_back(hunt_lab_from_rgb(glm::clamp(rgb, 0.0f, 1.0f)));
  }
  return seen;
}

ColorImage display_light(const ColorImage& picture, float exposure_ev) {
  ColorImage result = picture;
  const float scale = std::exp2(exposure_ev);
  for (Color& pixel : result.pixels) {
    for (int c = 0; c < 3; ++c) pixel[c] = tone_curve(pixel[c] * scale, ToneMap::srgb);
  }
  return result;
}

}  // namespace

std::vector<float> flip_of_display_light(const ColorImage& reference, const ColorImage& image, float pixels_per_degree) {
  const Seen r = see(reference, pixels_per_degree), i = see(image, pixels_per_degree);
  std::vector<float> map(reference.pixels.size());
  for (std::size_t p = 0; p < map.size(); ++p) {
    const float color = redistributed(hyab(r.lab[p], i.lab[p]));
    const float edge = std::fabs(r.features.edges[p] - i.features.edges[p]), point = std::fabs(r.features.points[p] - i.features.points[p]);
    const float feature = std::pow(std::max(edge, point) * std::numbers::sqrt2_v<float> / 2, kFeatureExponent);
    map[p] = std::pow(color, 1 - feature);
  }
  return map;
}

std::vector<float> flip_map(const ColorImage& reference, const ColorImage& image, const MetricOptions& options) {
  check_comparable(reference, image, options);
  const ColorImage seen = with_reference_outside_mask(reference, image, options);
  return flip_of_display_light(display_light(reference, options.exposure_ev), display_light(seen, options.exposure_ev),
                               options.pixels_per_degree);
}

double compute_flip(const ColorImage& reference, const ColorImage& image, const MetricOptions& options) {
  return mean_counted(flip_map(reference, image, options), options);
}

}  // namespace sightline
