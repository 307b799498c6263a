// Which pixels count, and sums over them.
#pragma once

#include <cstddef>
#include <vector>

#include "image/metrics/metrics.h"

namespace sightline {

/// Throws Error{usage} unless the pictures have one size, the mask fits (or is empty), and at least one pixel counts.
void check_comparable(const ColorImage& reference, const ColorImage& image, const MetricOptions& options);

inline bool counts(const MetricOptions& options, std::size_t pixel) { return options.mask.empty() || options.mask[pixel] != 0; }

/// Calls visit(reference, image) with the values of each channel of each pixel that counts, in order; returns how many.
template <class Visit>
std::size_t for_each_value(const ColorImage& reference, const ColorImage& image, const MetricOptions& options, Visit&& visit) {
  check_comparable(reference, image, options);
  std::size_t count = 0;
  for (std::size_t i = 0; i < reference.pixels.size(); ++i) {
    if (!counts(options, i)) continue;
    for (int c = 0; c < 3; ++c) visit(double{reference.pixels[i][c]}, double{image.pixels[i][c]});
    count += 3;
  }
  return count;
}

/// Mean of a map over the pixels that count.
double mean_counted(const std::vector<float>& map, const MetricOptions& options);

/// error / norm, where no error is 0 even if the reference is black.
inline double ratio(double error, double norm) { return error == 0 ? 0 : error / norm; }

/// `image` with the reference's colours where the mask leaves pixels out, so that filters carry no error from there to pixels that count.
ColorImage with_reference_outside_mask(const ColorImage& reference, const ColorImage& image, const MetricOptions& options);

}  // namespace sightline
