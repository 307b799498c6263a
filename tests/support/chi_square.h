// Pearson's chi-square test: do samples follow the density that claims to describe them?
#pragma once

#include <functional>
#include <optional>
#include <random>
#include <span>
#include <string>

#include "base/math/vec.h"

namespace sightline::test {

/// Uniform floats in [0, 1) from a fixed seed.
class Uniform {
 public:
  explicit Uniform(std::uint32_t seed) : engine_(seed) {}
  float next() { return static_cast<float>(engine_() >> 8) * 0x1p-24f; }
  Vec2 next2() {
    const float x = next();
    return {x, next()};
  }

 private:
  std::mt19937 engine_;
};

/// Upper tail of the chi-square distribution.
double chi_square_tail(double statistic, int degrees_of_freedom);

/// Significance of one of `count` tests so that all together err with probability `family` (Sidak).
double sidak(double family, int count);

struct ChiSquareResult {
  double p_value = 1;
  double statistic = 0;
  int degrees_of_freedom = 0;
  std::string table;  ///< the cells that contribute most, for the failure message
};

/// Cells expected to hold fewer than `least_expected` are merged. A sample where none can fall gives p = 0.
ChiSquareResult chi_square(std::span<const double> observed, std::span<const double> expected, double least_expected = 5);

/// Where directions are counted: cells of polar coordinates around `axis`, crowded towards it by `power` (see PolarMap).
struct DirectionGrid {
  Vec3 axis{0, 0, 1};
  float power = 1;
  int rows = 16, columns = 16;
  bool far_lobe = false;  ///< another narrow lobe lies far from the axis, where cells are wide: look closer there
};

/// Draws `count` directions (none: a sample without direction) and compares them with `pdf` (solid angle), integrated over each cell; what
/// the density lacks to 1 is expected as samples without direction.
ChiSquareResult chi_square_directions(const std::function<std::optional<Vec3>()>& sample, const std::function<double(const Vec3&)>& pdf,
                                      const DirectionGrid& grid, int count);

}  // namespace sightline::test
