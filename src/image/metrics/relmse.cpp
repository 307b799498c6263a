// Relative mean squared error: 1/N Σ (I − R)² / (R² + ε), ε = 0.01, a channel of linear radiance at a time [Rousselle2011].
#include "image/metrics/metric_functions.h"
#include "image/metrics/pixels.h"

namespace sightline {

double compute_relmse(const ColorImage& reference, const ColorImage& image, const MetricOptions& options) {
  constexpr double epsilon = 0.01;
  double sum = 0;
  const std::size_t count =
      for_each_value(reference, image, options, [&](double r, double i) { sum += (i - r) * (i - r) / (r * r + epsilon); });
  return sum / static_cast<double>(count);
}

}  // namespace sightline
