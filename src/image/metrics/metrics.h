// Error metrics between a reference and a picture. One file a metric; this header lists them all.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "image/image.h"

namespace sightline {

struct MetricOptions {
  float exposure_ev = 0;               ///< for metrics taken on the tone-mapped picture
  float pixels_per_degree = 67;        ///< for FLIP
  std::span<const std::uint8_t> mask;  ///< one byte a pixel, 0 = leave out; empty = all pixels
};

/// A metric: its name, one line of formula, whether larger is better, and how to compute it. Pictures have equal size.
struct Metric {
  std::string name, formula;
  bool larger_is_better = false;
  double (*compute)(const ColorImage& reference, const ColorImage& image, const MetricOptions& options);
};

/// mse, rmse, relmse, nmse, l2, linf, psnr, ssim, flip, hdrflip; the explicit table.
const std::vector<Metric>& metrics();
const Metric& find_metric(std::string_view name);  ///< Error{usage} with the nearest name

/// Error per pixel of LDR-FLIP, 0..1, and HDR-FLIP's (the maximum over its exposures).
std::vector<float> flip_map(const ColorImage& reference, const ColorImage& image, const MetricOptions& options);
std::vector<float> hdrflip_map(const ColorImage& reference, const ColorImage& image, const MetricOptions& options);

}  // namespace sightline
