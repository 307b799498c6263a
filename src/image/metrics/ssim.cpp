// Structural similarity [Wang2004, Eq. 13], mean over pixels:
//   (2 μr μi + C1)(2 σri + C2) / ((μr² + μi² + C1)(σr² + σi² + C2)),  C1 = 0.01², C2 = 0.03²,
// with means, variances and covariance under a Gaussian window of 11 x 11 pixels, σ = 1.5, of the luma (Rec.709 weights of the
// sRGB-encoded values after exposure and clipping).
// Deviation: at the border and beside pixels that the mask leaves out, the window shrinks to the pixels that count, instead of such
// places being left out altogether; small pictures and masks with fine detail would have no values otherwise.
#include <cmath>

#include "image/metrics/convolve.h"
#include "image/metrics/metric_functions.h"
#include "image/metrics/pixels.h"
#include "image/tone_map.h"

namespace sightline {
namespace {

float luma(const Color& linear, float exposure_ev) { return luminance(tone_map(linear, ToneMap::srgb, exposure_ev)); }

}  // namespace

double compute_ssim(const ColorImage& reference, const ColorImage& image, const MetricOptions& options) {
  check_comparable(reference, image, options);
  const std::vector<float> kernel = gaussian_kernel(1.5, 5);
  const auto window_sum = [&](auto&& value) {
    Plane plane(reference.width, reference.height);
    for (std::size_t p = 0; p < plane.values.size(); ++p) plane.values[p] = counts(options, p) ? value(p) : 0.0f;
    return filter_columns(filter_rows(plane, kernel, Border::zero), kernel, Border::zero).values;
  };
  std::vector<float> r, i;
  for (std::size_t p = 0; p < reference.pixels.size(); ++p) {
    r.push_back(luma(reference.pixels[p], options.exposure_ev));
    i.push_back(luma(image.pixels[p], options.exposure_ev));
  }
  const std::vector<float> weight = window_sum([](std::size_t) { return 1.0f; });
  const std::vector<float> sum_r = window_sum([&](std::size_t p) { return r[p]; }), sum_i = window_sum([&](std::size_t p) { return i[p]; });
  const std::vector<float> sum_rr = window_sum([&](std::size_t p) { return r[p] * r[p]; });
  const std::vector<float> sum_ii = window_sum([&](std::size_t p) { return i[p] * i[p]; });
  const std::vector<float> sum_ri = window_sum([&](std::size_t p) { return r[p] * i[p]; });

  constexpr double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
  std::vector<float> map(reference.pixels.size(), 0.0f);
  for (std::size_t p = 0; p < map.size(); ++p) {
    if (!counts(options, p)) continue;
    const double w = weight[p], mean_r = sum_r[p] / w, mean_i = sum_i[p] / w;
    const double variance_r = sum_rr[p] / w - mean_r * mean_r, variance_i = sum_ii[p] / w - mean_i * mean_i;
    const double covariance = sum_ri[p] / w - mean_r * mean_i;
    map[p] = static_cast<float>((2 * mean_r * mean_i + c1) * (2 * covariance + c2) /
                                ((mean_r * mean_r + mean_i * mean_i + c1) * (variance_r + variance_i + c2)));
  }
  return mean_counted(map, options);
}

}  // namespace sightline
