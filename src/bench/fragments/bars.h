// What a picture is worth on Monte Carlo's scale of time and error: arithmetic alone.
#pragma once

#include <optional>
#include <span>

namespace sightline {

/// A picture: how long it took and how far from the reference it is.
struct TimedError {
  double seconds = 0, l2 = 0, psnr = 0;
};
/// Monte Carlo with so many samples a pixel.
struct CurvePoint {
  int samples = 0;
  TimedError value;
};

/// Time of Monte Carlo with an error that is no worse, over ours.
struct EqualError {
  int samples = 0;  ///< the smallest number measured whose l2 is no worse; 0: none is, and `ratio` is that of the largest, a lower bound
  double ratio = 0;
  /// Between the measured numbers, l2 taken as a power of the number and time as linear in it; nothing outside of them.
  std::optional<double> interpolated_samples, interpolated_ratio;
};
/// `curve` is sorted by samples and not empty.
EqualError equal_error(std::span<const CurvePoint> curve, const TimedError& ours);

/// PSNR of ours minus that of Monte Carlo in the same time, interpolated over the logarithm of time. Where ours is faster than the
/// smallest number of samples, that one is taken: a lower bound. Nothing where ours is slower than all.
std::optional<double> equal_time_gain(std::span<const CurvePoint> curve, const TimedError& ours);

/// Time of `samples` over ours; nothing if they were not measured.
std::optional<double> time_ratio(std::span<const CurvePoint> curve, int samples, const TimedError& ours);

/// The largest |value / mean - 1|; 0 for nothing.
double largest_deviation(std::span<const double> values);

}  // namespace sightline
