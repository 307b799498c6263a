#include "bench/fragments/bars.h"

#include <algorithm>
#include <cmath>

namespace sightline {
namespace {

double mix(double a, double b, double t) { return a + t * (b - a); }

}  // namespace

EqualError equal_error(std::span<const CurvePoint> curve, const TimedError& ours) {
  EqualError result;
  if (curve.empty() || !(ours.seconds > 0)) return result;
  const auto found = std::find_if(curve.begin(), curve.end(), [&](const CurvePoint& point) { return point.value.l2 <= ours.l2; });
  if (found == curve.end()) {
    result.ratio = curve.back().value.seconds / ours.seconds;
    return result;
  }
  result.samples = found->samples;
  result.ratio = found->value.seconds / ours.seconds;
  if (found == curve.begin()) return result;
  const CurvePoint &above = *(found - 1), &below = *found;
  if (!(below.value.l2 > 0)) return result;
  // Straight between the two in logarithms of samples and error.
  const double t = std::log(above.value.l2 / ours.l2) / std::log(above.value.l2 / below.value.l2);
  const double samples = std::exp(mix(std::log(above.samples), std::log(below.samples), t));
  const double share = (samples - above.samples) / (below.samples - above.samples);
  result.interpolated_samples = samples;
  result.interpolated_ratio = mix(above.value.seconds, below.value.seconds, share) / ours.seconds;
  return result;
}

std::optional<double> equal_time_gain(std::span<const CurvePoint> curve, const TimedError& ours) {
  if (curve.empty()) return std::nullopt;
  if (ours.seconds <= curve.front().value.seconds) return ours.psnr - curve.front().value.psnr;
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const TimedError &a = curve[i - 1].value, &b = curve[i].value;
    if (!(a.seconds < ours.seconds && ours.seconds <= b.seconds)) continue;
    const double t = std::log(ours.seconds / a.seconds) / std::log(b.seconds / a.seconds);
    return ours.psnr - mix(a.psnr, b.psnr, t);
  }
  return std::nullopt;
}

std::optional<double> time_ratio(std::span<const CurvePoint> curve, int samples, const TimedError& ours) {
  for (const CurvePoint& point : curve) {
    if (point.samples == samples && ours.seconds > 0) return point.value.seconds / ours.seconds;
  }
  return std::nullopt;
}

double largest_deviation(std::span<const double> values) {
  double sum = 0, largest = 0;
  for (const double value : values) sum += value;
  const double mean = values.empty() ? 0 : sum / static_cast<double>(values.size());
  if (!(mean > 0)) return 0;
  for (const double value : values) largest = std::max(largest, std::abs(value / mean - 1));
  return largest;
}

}  // namespace sightline
