// Normalised squared error: Σ (I − R)² / Σ R. It depends on the scale of radiance, as the papers that use it do.
#include "image/metrics/metric_functions.h"
#include "image/metrics/pixels.h"

namespace sightline {

double compute_nmse(const ColorImage& reference, const ColorImage& image, const MetricOptions& options) {
  double error = 0, norm = 0;
  for_each_value(reference, image, options, [&](double r, double i) {
    error += (i - r) * (i - r);
    norm += r;
  });
  return ratio(error, norm);
}

}  // namespace sightline
