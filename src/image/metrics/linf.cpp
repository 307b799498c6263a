// Relative mean absolute error: Σ |I − R| / Σ R, under the name that the visibility caching paper gives it.
#include <cmath>

#include "image/metrics/metric_functions.h"
#include "image/metrics/pixels.h"

namespace sightline {

double compute_linf(const ColorImage& reference, const ColorImage& image, const MetricOptions& options) {
  double error = 0, norm = 0;
  for_each_value(reference, image, options, [&](double r, double i) {
    error += std::fabs(i - r);
    norm += r;
  });
  return ratio(error, norm);
}

}  // namespace sightline
