#include "base/sample/distribution2d.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace sightline {
namespace {

constexpr float kBelowOne = 0x1.fffffep-1f;

/// Cumulative shares of `values` from exactly 0 to exactly 1, uniform if their sum is 0; returns the sum.
template <class Value>
double accumulate(std::size_t n, float* cumulative, Value&& value) {
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += value(i);
  double running = 0;
  cumulative[0] = 0;
  for (std::size_t i = 0; i < n; ++i) {
    running += value(i);
    cumulative[i + 1] = static_cast<float>(sum > 0 ? running / sum : static_cast<double>(i + 1) / static_cast<double>(n));
  }
  // Trailing empty cells stay empty under rounding.
  for (std::size_t i = n; i > 0 && (i == n || value(i) == 0); --i) cumulative[i] = 1;
  return sum;
}

struct Inverted {
  std::uint32_t cell;
  float offset;  ///< inside the cell, in [0,1)
};

Inverted invert(const float* cumulative, std::uint32_t n, float u) {
  const float clamped = std::clamp(u, 0.f, kBelowOne);
  // The last cell that begins at or below u: cells without weight begin where the next one does and are passed over.
  const float* above = std::upper_bound(cumulative, cumulative + n + 1, clamped);
  const auto cell = static_cast<std::uint32_t>(std::clamp<std::ptrdiff_t>(above - cumulative - 1, 0, static_cast<std::ptrdiff_t>(n) - 1));
  const float width = cumulative[cell + 1] - cumulative[cell];
  return {cell, width > 0 ? std::min((clamped - cumulative[cell]) / width, kBelowOne) : 0.5f};
}

}  // namespace

Distribution2D::Distribution2D(std::span<const float> values, std::uint32_t width, std::uint32_t height)
    : width_(width),
      height_(height),
      densities_(values.size()),
      conditional_((width + std::size_t{1}) * height),
      marginal_(height + std::size_t{1}) {
  if (values.empty()) return;
  const auto valid = [&](std::size_t i) { return values[i] > 0 && std::isfinite(values[i]) ? static_cast<double>(values[i]) : 0.0; };
  std::vector<double> row_sums(height);
  for (std::size_t y = 0; y < height; ++y) {
    row_sums[y] = accumulate(width, &conditional_[y * (width + std::size_t{1})], [&](std::size_t x) { return valid(y * width + x); });
  }
  mean_ = accumulate(height, marginal_.data(), [&](std::size_t y) { return row_sums[y]; }) / static_cast<double>(values.size());
  if (!(mean_ > 0)) return;
  for (std::size_t i = 0; i < values.size(); ++i) densities_[i] = static_cast<float>(valid(i) / mean_);
}

Distribution2D::Sample Distribution2D::sample(const Vec2& u) const {
  const Inverted row = invert(marginal_.data(), height_, u.y);
  const Inverted column = invert(&conditional_[row.cell * (width_ + std::size_t{1})], width_, u.x);
  // The sum rounds: a point must not leave its cell upwards.
  const auto inside = [](const Inverted& i, std::uint32_t n) {
    const float position = (static_cast<float>(i.cell) + i.offset) / static_cast<float>(n);
    return std::min(position, std::nextafter(static_cast<float>(i.cell + 1) / static_cast<float>(n), 0.f));
  };
  return {{inside(column, width_), inside(row, height_)},
          densities_[row.cell * static_cast<std::size_t>(width_) + column.cell],
          column.cell,
          row.cell};
}

float Distribution2D::pdf(const Vec2& uv) const {
  if (!(uv.x >= 0 && uv.x < 1 && uv.y >= 0 && uv.y < 1) || !can_sample()) return 0;
  const auto x = std::min(static_cast<std::uint32_t>(uv.x * static_cast<float>(width_)), width_ - 1);
  const auto y = std::min(static_cast<std::uint32_t>(uv.y * static_cast<float>(height_)), height_ - 1);
  return densities_[y * static_cast<std::size_t>(width_) + x];
}

}  // namespace sightline
