// Minimisation without derivatives [Nelder1965].
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace sightline::fit {

template <std::size_t N>
using Point = std::array<double, N>;

/// The least point of `f` near `start`, whose first simplex reaches `step` along each axis; ends when the simplex is flat to within
/// `tolerance` of its value or after `limit` evaluations.
template <std::size_t N, class F>
Point<N> minimize(const F& f, const Point<N>& start, const Point<N>& step, double tolerance = 1e-7, int limit = 600) {
  struct Vertex {
    Point<N> x;
    double value;
  };
  std::array<Vertex, N + 1> simplex;
  for (std::size_t i = 0; i <= N; ++i) {
    simplex[i].x = start;
    if (i > 0) simplex[i].x[i - 1] += step[i - 1];
    simplex[i].value = f(simplex[i].x);
  }
  for (int used = N + 1; used < limit;) {
    std::sort(simplex.begin(), simplex.end(), [](const Vertex& a, const Vertex& b) { return a.value < b.value; });
    Vertex& worst = simplex[N];
    if (!(worst.value - simplex[0].value > tolerance * std::fabs(simplex[0].value))) break;
    Point<N> centre{};
    for (std::size_t i = 0; i < N; ++i)
      for (std::size_t k = 0; k < N; ++k) centre[k] += simplex[i].x[k] / N;
    // Reflection (1), expansion (2), contraction (1/2, outside or inside).
    const auto moved = [&](double amount) {
      Vertex v;
      for (std::size_t k = 0; k < N; ++k) v.x[k] = centre[k] + amount * (centre[k] - worst.x[k]);
      v.value = f(v.x);
      ++used;
      return v;
    };
    const Vertex reflected = moved(1);
    if (reflected.value < simplex[0].value) {
      const Vertex expanded = moved(2);
      worst = expanded.value < reflected.value ? expanded : reflected;
    } else if (reflected.value < simplex[N - 1].value) {
      worst = reflected;
    } else {
      const bool outside = reflected.value < worst.value;
      const Vertex contracted = moved(outside ? 0.5 : -0.5);
      if (contracted.value < std::min(reflected.value, worst.value)) {
        worst = contracted;
      } else {
        for (std::size_t i = 1; i <= N; ++i) {
          for (std::size_t k = 0; k < N; ++k) simplex[i].x[k] = 0.5 * (simplex[0].x[k] + simplex[i].x[k]);
          simplex[i].value = f(simplex[i].x);
          ++used;
        }
      }
    }
  }
  return std::min_element(simplex.begin(), simplex.end(), [](const Vertex& a, const Vertex& b) { return a.value < b.value; })->x;
}

}  // namespace sightline::fit
