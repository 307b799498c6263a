// Reconstruction filters, importance-sampled: a sample belongs to one pixel and has weight 1.
#pragma once

#include <array>
#include <string_view>

namespace sightline {

/// Separable filter as an inverse distribution: offset(u) is distributed like the filter kernel, in pixels from the centre.
class PixelFilter {
 public:
  static constexpr int kEntries = 1024;
  enum class Kind { gaussian, box, centre };

  PixelFilter() : PixelFilter(Kind::gaussian) {}
  explicit PixelFilter(Kind kind);
  /// Offset for u in [0,1), piecewise linear in the table.
  float offset(float u) const {
    const float x = u * kEntries;
    const int i = static_cast<int>(x);
    const float f = x - static_cast<float>(i);
    return table_[static_cast<std::size_t>(i)] * (1 - f) + table_[static_cast<std::size_t>(i) + 1] * f;
  }
  const float* table() const { return table_.data(); }
  Kind kind() const { return kind_; }

 private:
  Kind kind_;
  std::array<float, kEntries + 1> table_;
};

/// gaussian (σ 0.5 px, radius 1.5 px; default), box (1 px), centre (no jitter). Throws Error{usage}.
PixelFilter pixel_filter_from_name(std::string_view name);
std::string_view pixel_filter_name(PixelFilter::Kind kind);

}  // namespace sightline
