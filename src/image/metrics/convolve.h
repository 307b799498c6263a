// Separable filters on single-channel planes.
#pragma once

#include <span>
#include <vector>

namespace sightline {

struct Plane {
  int width = 0, height = 0;
  std::vector<float> values;

  Plane(int w, int h) : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
};

/// What lies outside of a picture: its nearest pixel, or nothing.
enum class Border { clamp, zero };

/// Correlation of every row, or column, with an odd kernel centred on the pixel: out(x) = Σ_k kernel(k) in(x + k − radius).
Plane filter_rows(const Plane& in, std::span<const float> kernel, Border border);
Plane filter_columns(const Plane& in, std::span<const float> kernel, Border border);

/// exp(−x² / (2 σ²)) for x = −radius ... radius, in pixels, not normalised.
std::vector<float> gaussian_kernel(double sigma, int radius);

}  // namespace sightline
