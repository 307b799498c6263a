// Peak signal-to-noise ratio in dB: 10 log10(1 / mse), on the sRGB-encoded values 0..1 after exposure and clipping (not yet rounded to
// 8 bits). Infinite for equal pictures.
#include <cmath>
#include <limits>

#include "image/metrics/metric_functions.h"
#include "image/metrics/pixels.h"
#include "image/tone_map.h"

namespace sightline {

double compute_psnr(const ColorImage& reference, const ColorImage& image, const MetricOptions& options) {
  check_comparable(reference, image, options);
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t p = 0; p < reference.pixels.size(); ++p) {
    if (!counts(options, p)) continue;
    const Color r = tone_map(reference.pixels[p], ToneMap::srgb, options.exposure_ev);
    const Color i = tone_map(image.pixels[p], ToneMap::srgb, options.exposure_ev);
    for (int c = 0; c < 3; ++c) sum += (double{i[c]} - r[c]) * (double{i[c]} - r[c]);
    count += 3;
  }
  return sum == 0 ? std::numeric_limits<double>::infinity() : 10 * std::log10(static_cast<double>(count) / sum);
}

}  // namespace sightline
