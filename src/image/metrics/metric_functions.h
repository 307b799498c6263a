// The function behind each metric, one file each; metrics.cpp lists them.
#pragma once

#include "image/metrics/metrics.h"

namespace sightline {

double compute_mse(const ColorImage& reference, const ColorImage& image, const MetricOptions& options);
double compute_rmse(const ColorImage& reference, const ColorImage& image, const MetricOptions& options);
double compute_relmse(const ColorImage& reference, const ColorImage& image, const MetricOptions& options);
double compute_nmse(const ColorImage& reference, const ColorImage& image, const MetricOptions& options);
double compute_l2(const ColorImage& reference, const ColorImage& image, const MetricOptions& options);
double compute_linf(const ColorImage& reference, const ColorImage& image, const MetricOptions& options);
double compute_psnr(const ColorImage& reference, const ColorImage& image, const MetricOptions& options);
double compute_ssim(const ColorImage& reference, const ColorImage& image, const MetricOptions& options);
double compute_flip(const ColorImage& reference, const ColorImage& image, const MetricOptions& options);
double compute_hdrflip(const ColorImage& reference, const ColorImage& image, const MetricOptions& options);

}  // namespace sightline
