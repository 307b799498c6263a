// Mean squared error: 1/N Σ (I − R)², over N = 3 x pixels values.
#include "image/metrics/metric_functions.h"
#include "image/metrics/pixels.h"

namespace sightline {

double compute_mse(const ColorImage& reference, const ColorImage& image, const MetricOptions& options) {
  double sum = 0;
  const std::size_t count = for_each_value(reference, image, options, [&](double r, double i) { sum += (i - r) * (i - r); });
  return sum / static_cast<double>(count);
}

}  // namespace sightline
