#include "image/metrics/convolve.h"

#include <algorithm>
#include <cmath>

namespace sightline {

Plane filter_rows(const Plane& in, std::span<const float> kernel, Border border) {
  Plane out(in.width, in.height);
  const std::size_t width = static_cast<std::size_t>(in.width), radius = kernel.size() / 2;
  // A row with its border, so that the inner loop has no conditions and becomes vector code.
  std::vector<float> row(width + 2 * radius, 0.0f);
  for (std::size_t y = 0; y < static_cast<std::size_t>(in.height); ++y) {
    const float* source = in.values.data() + y * width;
    std::copy(source, source + width, row.begin() + static_cast<std::ptrdiff_t>(radius));
    if (border == Border::clamp) {
      std::fill_n(row.begin(), radius, source[0]);
      std::fill_n(row.end() - static_cast<std::ptrdiff_t>(radius), radius, source[width - 1]);
    }
    float* target = out.values.data() + y * width;
    for (std::size_t k = 0; k < kernel.size(); ++k) {
      const float weight = kernel[k];
      for (std::size_t x = 0; x < width; ++x) target[x] += weight * row[x + k];
    }
  }
  return out;
}

Plane filter_columns(const Plane& in, std::span<const float> kernel, Border border) {
  Plane out(in.width, in.height);
  const std::size_t width = static_cast<std::size_t>(in.width);
  const int radius = static_cast<int>(kernel.size() / 2);
  for (int y = 0; y < in.height; ++y) {
    float* target = out.values.data() + static_cast<std::size_t>(y) * width;
    for (std::size_t k = 0; k < kernel.size(); ++k) {
      int source_y = y + static_cast<int>(k) - radius;
      if (border == Border::zero && (source_y < 0 || source_y >= in.height)) continue;
      source_y = std::clamp(source_y, 0, in.height - 1);
      const float* source = in.values.data() + static_cast<std::size_t>(source_y) * width;
      const float weight = kernel[k];
      for (std::size_t x = 0; x < width; ++x) target[x] += weight * source[x];
    }
  }
  return out;
}

std::vector<float> gaussian_kernel(double sigma, int radius) {
  std::vector<float> kernel;
  for (int x = -radius; x <= radius; ++x) kernel.push_back(static_cast<float>(std::exp(-0.5 * x * x / (sigma * sigma))));
  return kernel;
}

}  // namespace sightline
