// Adaptive quadrature over the sphere of directions, for lobes of any width.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "base/math/frame.h"
#include "base/sample/warp.h"

namespace sightline {

/// Polar coordinates (s, turn) in the unit square around an axis, 1 - cos(theta) = 2 s^power: a power above 1 crowds equal steps of s near
/// the axis, so that a narrow lobe there gets its share of them.
class PolarMap {
 public:
  PolarMap(const Vec3& axis, float power) : frame_(frame_from_normal(axis)), power_(power) {}

  Vec3 direction(double s, double turn) const {
    const double drop = 2 * std::pow(s, power_);
    const double radius = std::sqrt(std::max(0.0, drop * (2 - drop)));
    const double phi = 2 * std::numbers::pi * turn;
    return frame_.to_world(
        Vec3(static_cast<float>(radius * std::cos(phi)), static_cast<float>(radius * std::sin(phi)), static_cast<float>(1 - drop)));
  }
  /// Solid angle over area of the square.
  double jacobian(double s) const { return 4 * std::numbers::pi * power_ * std::pow(s, power_ - 1); }
  Vec2 invert(const Vec3& direction) const {
    const Vec3 w = frame_.to_local(direction);
    const float drop = w.z > 0 ? (w.x * w.x + w.y * w.y) / (1 + w.z) : 1 - w.z;
    return {std::min(std::pow(std::max(0.f, 0.5f * drop), 1 / power_), kOneMinusEpsilon), azimuth_turn(w.x, w.y)};
  }

 private:
  Frame3 frame_;
  float power_;
};

/// A rectangle of the unit square.
struct SquareCell {
  double x0, x1, y0, y1;
};

/// Integral of `f(x, y)`, a glm::dvec4, over the cell: 4 x 4 Gauss-Legendre points, halved in both axes until halving changes it by less
/// than `tolerance` or `depth` is used up; the first `forced` halvings are made in any case, lest a peak between the points be missed.
template <class F>
glm::dvec4 integrate_cell(const F& f, const SquareCell& cell, double tolerance, int depth, int forced = 0) {
  const auto gauss = [&f](const SquareCell& c) {
    constexpr std::array<double, 4> kNode{-0.8611363115940526, -0.3399810435848563, 0.3399810435848563, 0.8611363115940526};
    constexpr std::array<double, 4> kWeight{0.3478548451374538, 0.6521451548625461, 0.6521451548625461, 0.3478548451374538};
    const double half_x = 0.5 * (c.x1 - c.x0), half_y = 0.5 * (c.y1 - c.y0);
    glm::dvec4 sum(0);
    for (std::size_t i = 0; i < kNode.size(); ++i)
      for (std::size_t j = 0; j < kNode.size(); ++j)
        sum += kWeight[i] * kWeight[j] * f(c.x0 + half_x * (1 + kNode[i]), c.y0 + half_y * (1 + kNode[j]));
    return sum * (half_x * half_y);
  };
  const auto quarters = [](const SquareCell& c) {
    const double x = 0.5 * (c.x0 + c.x1), y = 0.5 * (c.y0 + c.y1);
    return std::array<SquareCell, 4>{SquareCell{c.x0, x, c.y0, y}, SquareCell{x, c.x1, c.y0, y}, SquareCell{c.x0, x, y, c.y1},
                                     SquareCell{x, c.x1, y, c.y1}};
  };
  const auto refine = [&](const auto& self, const SquareCell& c, const glm::dvec4& coarse, int levels) -> glm::dvec4 {
    const auto parts = quarters(c);
    std::array<glm::dvec4, 4> fine;
    glm::dvec4 total(0);
    for (std::size_t i = 0; i < parts.size(); ++i) total += fine[i] = gauss(parts[i]);
    const glm::dvec4 change = glm::abs(total - coarse);
    if (levels <= 1 || (levels <= depth - forced && std::max(std::max(change.x, change.y), std::max(change.z, change.w)) < tolerance))
      return total;
    total = glm::dvec4(0);
    for (std::size_t i = 0; i < parts.size(); ++i) total += self(self, parts[i], fine[i], levels - 1);
    return total;
  };
  return refine(refine, cell, gauss(cell), depth);
}

}  // namespace sightline
