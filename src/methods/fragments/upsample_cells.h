// A LightSignal seen as a partition of the picture into squares with one sample each.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "methods/fragments/g_buffer.h"
#include "methods/fragments/light_signal.h"

namespace sightline {

/// A square of pixels whose sample stands for its centre: a fragment, or one quadrant of it.
struct Cell {
  int x, y, size;
};

/// A value at a place; pixel (x, y) has its centre at (x + 1/2, y + 1/2).
struct SignalSample {
  float x = 0, y = 0;
  int width = 1;
  int level = 0;  ///< width = 2^level
  std::array<float, 3> value{};
};

/// Cells are fragments, whose sample is the mean of their quadrants, or (`quadrants`) the quadrants themselves. Pixels asked for lie
/// inside the picture.
class SignalCells {
 public:
  SignalCells(const GBuffer& g, const LightSignal& signal, bool quadrants) : g_(g), signal_(signal), quadrants_(quadrants) {}

  const GBuffer& g() const { return g_; }
  const LightSignal& signal() const { return signal_; }
  int channels() const { return signal_.channels; }

  Cell cell(int x, int y) const {
    const int level = signal_.level[g_.at(x, y)], size = quadrants_ && level > 0 ? 1 << (level - 1) : 1 << level;
    return {x & ~(size - 1), y & ~(size - 1), size};
  }
  SignalSample sample(const Cell& cell) const;
  SignalSample extra(int x, int y) const;
  bool has_extra(int x, int y) const { return (signal_.flags[g_.at(x, y)] & LightSignal::kExtra) != 0; }
  bool unlit(int x, int y) const { return (signal_.flags[g_.at(x, y)] & LightSignal::kUnlit) != 0; }

  /// Whether the value of this pixel says anything about others. The visible share of a light that the pixel faces away from does not.
  bool speaks(int x, int y) const {
    const PixelKind kind = g_.kind[g_.at(x, y)];
    return (kind == PixelKind::diffuse || kind == PixelKind::analytic) && !(channels() == 1 && unlit(x, y));
  }
  /// The pixel at a cell's centre stands for it in what follows.
  std::size_t centre_pixel(const Cell& cell) const {
    const int x = cell.x + cell.size / 2, y = cell.y + cell.size / 2;
    return g_.at(x < g_.width ? x : g_.width - 1, y < g_.height ? y : g_.height - 1);
  }
  /// Whether two pixels may lie on one smooth surface. Symmetric: both sides of a border agree whether there is an edge.
  bool connected(std::size_t a, std::size_t b) const;

 private:
  const GBuffer& g_;
  const LightSignal& signal_;
  bool quadrants_;
};

}  // namespace sightline
