// Interpolation of scattered samples by radial basis functions: at most four samples a texel.
#pragma once

#include <array>
#include <cstddef>

#include "methods/fragments/upsample_cells.h"

namespace sightline {

/// Samples of which a texel takes the nearest, as a structure of arrays.
struct RbfCandidates {
  static constexpr std::size_t kCapacity = 144;  ///< an edge of 128 pixels, its additional samples, and room for whole vectors

  std::size_t count = 0;
  alignas(kCacheLine) std::array<float, kCapacity> x, y, width, level;
  alignas(kCacheLine) std::array<std::array<float, kCapacity>, 3> value;

  void add(const SignalSample& sample, int channels) {
    x[count] = sample.x, y[count] = sample.y;
    width[count] = static_cast<float>(sample.width), level[count] = static_cast<float>(sample.level);
    for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c) value[c][count] = sample.value[c];
    ++count;
  }
};

/// A square of texels that share their candidates: a quadrant of a cell, `size` pixels (a power of two) from (x0, y0) on.
struct RbfRegion {
  int x0 = 0, y0 = 0, size = 1;
  float cell_width = 1;  ///< unit of distances; samples further than two of them are not used
  bool adaptive = true;  ///< else C = 1
  int channels = 1;
  SignalSample own;
  std::array<const RbfCandidates*, 3> candidates{};  ///< the nearest of each, if there is any, joins the texel's own sample; null: none
};

/// Writes texel (x0 + i, y0 + j) to out[c][j * out_stride + i], for i < columns and j < rows. The definition.
void rbf_region(const RbfRegion& region, int columns, int rows, const std::array<float*, 3>& out, std::size_t out_stride);
/// The same within a thousandth of the samples' range (the matrix may be nearly singular), many texels at a time.
void rbf_region_lanes(const RbfRegion& region, int columns, int rows, const std::array<float*, 3>& out, std::size_t out_stride);

}  // namespace sightline
