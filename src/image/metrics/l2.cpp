// Relative squared L2 norm: ‖I − R‖² / ‖R‖² = Σ (I − R)² / Σ R².
#include "image/metrics/metric_functions.h"
#include "image/metrics/pixels.h"

namespace sightline {

double compute_l2(const ColorImage& reference, const ColorImage& image, const MetricOptions& options) {
  double error = 0, norm = 0;
  for_each_value(reference, image, options, [&](double r, double i) {
    error += (i - r) * (i - r);
    norm += r * r;
  });
  return ratio(error, norm);
}

}  // namespace sightline
