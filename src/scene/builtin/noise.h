// Gradient noise over the unit cube, evaluated a grid row at a time.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/math/vec.h"

namespace sightline::builtin {

/// Octaves of gradient noise with Perlin's fade curve [Perlin2002], sampled on a regular grid of resolution + 1 points an axis. Along a
/// row everything but a line and a fade is constant within a lattice cell, so a sample costs about a nanosecond.
class NoiseGrid {
 public:
  NoiseGrid(std::uint64_t seed, int resolution, int frequency, int octaves);

  int resolution() const { return resolution_; }
  /// Values at grid points (0..resolution, y, z); thread-safe.
  void row(int y, int z, std::span<float> values) const;

 private:
  struct Octave {
    int cells;  ///< lattice cells an axis
    float amplitude;
    std::vector<Vec3> gradients;  ///< (cells + 1)^3, times amplitude
    std::vector<int> first;       ///< first grid point of each cell, and one past the last
    std::vector<float> offset, fade;
  };
  int resolution_;
  std::vector<Octave> octaves_;
};

}  // namespace sightline::builtin
