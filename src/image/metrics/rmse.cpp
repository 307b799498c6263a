// Root mean squared error: sqrt(1/N Σ (I − R)²).
#include <cmath>

#include "image/metrics/metric_functions.h"
#include "image/metrics/pixels.h"

namespace sightline {

double compute_rmse(const ColorImage& reference, const ColorImage& image, const MetricOptions& options) {
  return std::sqrt(compute_mse(reference, image, options));
}

}  // namespace sightline
