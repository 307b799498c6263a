// Piecewise-constant densities on the unit square.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/math/vec.h"

namespace sightline {

/// Density on [0,1)² proportional to a grid of values, row 0 at v = 0: a row by the marginal, then a column within it, each by inverting
/// its cumulative sum. The map is continuous and monotonic in both numbers, so stratified points stay stratified. Immutable once built.
class Distribution2D {
 public:
  struct Sample {
    Vec2 uv;
    float pdf;  ///< density on the unit square
    std::uint32_t x, y;
  };

  Distribution2D() = default;
  /// `values` has width * height entries; negative or non-finite ones count as 0.
  Distribution2D(std::span<const float> values, std::uint32_t width, std::uint32_t height);

  /// Only if can_sample().
  Sample sample(const Vec2& u) const;
  float pdf(const Vec2& uv) const;
  bool can_sample() const { return mean_ > 0; }
  double mean() const { return mean_; }  ///< of the values
  std::uint64_t memory_bytes() const { return (densities_.size() + conditional_.size() + marginal_.size()) * sizeof(float); }

 private:
  std::uint32_t width_ = 0, height_ = 0;
  std::vector<float> densities_;    ///< values / mean
  std::vector<float> conditional_;  ///< per row, width + 1 cumulative shares from 0 to 1
  std::vector<float> marginal_;     ///< height + 1
  double mean_ = 0;
};

}  // namespace sightline
