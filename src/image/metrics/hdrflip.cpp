// HDR-FLIP [Andersson2021]: the largest LDR-FLIP error a pixel over a series of exposures, each shown through a tone map, mean over
// pixels. The exposures reach from the one that just does not saturate the reference's brightest pixel to the one that shows its median
// as bright.
#include <algorithm>
#include <cmath>
#include <limits>

#include "image/metrics/flip_core.h"
#include "image/metrics/metric_functions.h"
#include "image/metrics/pixels.h"
#include "image/tone_map.h"

namespace sightline {
namespace {

/// The paper's tone map: the ACES fit after a factor of 0.6, which makes it fit without its creator's own pre-exposure.
constexpr float kPreExposure = 0.6f;

struct Exposures {
  float start = 0, stop = 0;
  int count = 1;
};

/// Linear value that the tone map turns into t: the positive root of (2.51 − 2.43 t) u² + (0.03 − 0.59 t) u − 0.14 t with u = 0.6 x.
double inverse_tone_map(double t) {
  const double a = 2.51 - 2.43 * t, b = 0.03 - 0.59 * t, c = -0.14 * t;
  return (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a) / kPreExposure;
}

Exposures automatic_exposures(const ColorImage& reference, const MetricOptions& options) {
  constexpr double nearly_saturated = 0.85;
  std::vector<float> luminances;
  for (std::size_t p = 0; p < reference.pixels.size(); ++p) {
    const float value = luminance(reference.pixels[p]);
    if (counts(options, p) && std::isfinite(value)) luminances.push_back(std::max(value, 0.0f));
  }
  if (luminances.empty()) return {};
  std::sort(luminances.begin(), luminances.end());
  const std::size_t half = luminances.size() / 2;
  const double middle = luminances.size() % 2 == 1 ? luminances[half] : 0.5 * (double{luminances[half - 1]} + luminances[half]);
  const double brightest = luminances.back(), median = std::max(middle, double{std::numeric_limits<float>::epsilon()});
  if (brightest <= 0) return {};
  const double target = inverse_tone_map(nearly_saturated);
  const double start = std::log2(target / brightest), stop = std::max(std::log2(target / median), start);
  return {static_cast<float>(start), static_cast<float>(stop), std::max(2, static_cast<int>(std::ceil(stop - start)))};
}

ColorImage shown(const ColorImage& picture, float exposure) {
  ColorImage result = picture;
  const float scale = kPreExposure * std::exp2(exposure);
  for (Color& pixel : result.pixels) {
    for (int c = 0; c < 3; ++c) pixel[c] = tone_curve(pixel[c] * scale, ToneMap::aces);
  }
  return result;
}

}  // namespace

std::vector<float> hdrflip_map(const ColorImage& reference, const ColorImage& image, const MetricOptions& options) {
  check_comparable(reference, image, options);
  const ColorImage seen = with_reference_outside_mask(reference, image, options);
  const Exposures exposures = automatic_exposures(reference, options);
  std::vector<float> largest(reference.pixels.size(), 0.0f);
  for (int e = 0; e < exposures.count; ++e) {
    const float step = exposures.count > 1 ? (exposures.stop - exposures.start) / static_cast<float>(exposures.count - 1) : 0.0f;
    const float exposure = exposures.start + static_cast<float>(e) * step;
    const std::vector<float> map = flip_of_display_light(shown(reference, exposure), shown(seen, exposure), options.pixels_per_degree);
    for (std::size_t p = 0; p < largest.size(); ++p) largest[p] = std::max(largest[p], map[p]);
  }
  return largest;
}

double compute_hdrflip(const ColorImage& reference, const ColorImage& image, const MetricOptions& options) {
  return mean_counted(hdrflip_map(reference, image, options), options);
}

}  // namespace sightline
