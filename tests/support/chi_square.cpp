#include "support/chi_square.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "shade/sphere_quadrature.h"

namespace sightline::test {

namespace {

/// Regularised upper incomplete gamma function Q(a, x): power series for small x, Lentz's continued fraction for large x.
double upper_gamma(double a, double x) {
  if (x <= 0) return 1;
  const double front = std::exp(-x + a * std::log(x) - std::lgamma(a));
  if (x < a + 1) {
    double term = 1 / a, sum = term;
    for (int n = 1; n < 10000 && term > sum * 1e-15; ++n) sum += term *= x / (a + n);
    return 1 - front * sum;
  }
  constexpr double kTiny = 1e-300;
  double b = x + 1 - a, c = 1 / kTiny, d = 1 / b, fraction = d;
  for (int n = 1; n < 10000; ++n) {
    const double numerator = -n * (n - a);
    b += 2;
    d = numerator * d + b;
    c = b + numerator / c;
    if (std::fabs(d) < kTiny) d = kTiny;
    if (std::fabs(c) < kTiny) c = kTiny;
    d = 1 / d;
    fraction *= d * c;
    if (std::fabs(d * c - 1) < 1e-15) break;
  }
  return front * fraction;
}

}  // namespace

double chi_square_tail(double statistic, int degrees_of_freedom) { return upper_gamma(0.5 * degrees_of_freedom, 0.5 * statistic); }

double sidak(double family, int count) { return -std::expm1(std::log1p(-family) / count); }

ChiSquareResult chi_square(std::span<const double> observed, std::span<const double> expected, double least_expected) {
  ChiSquareResult result;
  std::vector<std::size_t> order(expected.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return expected[a] < expected[b]; });
  struct Term {
    double value, observed, expected;
    std::size_t cell;
  };
  std::vector<Term> terms;
  double pooled_observed = 0, pooled_expected = 0;
  for (const std::size_t cell : order) {
    if (expected[cell] == 0 && observed[cell] > 0) {
      result.p_value = 0;
      result.table = fmt::format("cell {}: {} samples where the density is zero\n", cell, observed[cell]);
      return result;
    }
    pooled_observed += observed[cell];
    pooled_expected += expected[cell];
    if (pooled_expected < least_expected) continue;
    const double difference = pooled_observed - pooled_expected;
    terms.push_back({difference * difference / pooled_expected, pooled_observed, pooled_expected, cell});
    pooled_observed = pooled_expected = 0;
  }
  if (pooled_expected > 0 && !terms.empty()) {
    Term& last = terms.back();
    last.observed += pooled_observed;
    last.expected += pooled_expected;
    last.value = (last.observed - last.expected) * (last.observed - last.expected) / last.expected;
  }
  for (const Term& term : terms) result.statistic += term.value;
  result.degrees_of_freedom = static_cast<int>(terms.size()) - 1;
  if (result.degrees_of_freedom > 0) result.p_value = chi_square_tail(result.statistic, result.degrees_of_freedom);
  std::sort(terms.begin(), terms.end(), [](const Term& a, const Term& b) { return a.value > b.value; });
  for (std::size_t i = 0; i < std::min<std::size_t>(terms.size(), 8); ++i)
    result.table += fmt::format("cell {}: {} observed, {:.2f} expected\n", terms[i].cell, terms[i].observed, terms[i].expected);
  return result;
}

ChiSquareResult chi_square_directions(const std::function<std::optional<Vec3>()>& sample, const std::function<double(const Vec3&)>& pdf,
                                      const DirectionGrid& grid, int count) {
  const PolarMap map(grid.axis, grid.power);
  const auto rows = static_cast<std::size_t>(grid.rows), columns = static_cast<std::size_t>(grid.columns), cell_count = rows * columns;
  std::vector<double> observed(cell_count + 1, 0), expected(cell_count + 1, 0);
  for (int i = 0; i < count; ++i) {
    std::size_t cell = cell_count;
    if (const auto direction = sample()) {
      const Vec2 place = map.invert(*direction);
      cell = static_cast<std::size_t>(place.x * static_cast<float>(rows)) * columns +
             static_cast<std::size_t>(place.y * static_cast<float>(columns));
    }
    observed[cell] += 1;
  }
  double total = 0;
  for (std::size_t cell = 0; cell < cell_count; ++cell) {
    const auto row = static_cast<int>(cell) / grid.columns, column = static_cast<int>(cell) % grid.columns;
    const SquareCell area{row / static_cast<double>(grid.rows), (row + 1) / static_cast<double>(grid.rows),
                          column / static_cast<double>(grid.columns), (column + 1) / static_cast<double>(grid.columns)};
    const auto integrand = [&](double s, double turn) { return glm::dvec4(pdf(map.direction(s, turn)) * map.jacobian(s), 0, 0, 0); };
    // A cell may err by 2 % of the standard deviation of its count, which no test of this size notices.
    const int forced = grid.far_lobe && 2 * row >= grid.rows ? 3 : 0;
    const double probability = integrate_cell(integrand, area, 0.02 / std::sqrt(static_cast<double>(count) * 100), 7, forced).x;
    expected[cell] = probability * count;
    total += probability;
  }
  expected[cell_count] = std::max(0.0, 1 - total) * count;
  // Rounding of the quadrature must not forbid or demand samples without a direction.
  if (expected[cell_count] < 1e-4 * count && observed[cell_count] < 1e-4 * count) expected[cell_count] = observed[cell_count];
  ChiSquareResult result = chi_square(observed, expected);
  if (total > 1 + 2e-3) {
    result.p_value = 0;
    result.table += fmt::format("the density integrates to {}\n", total);
  }
  return result;
}

}  // namespace sightline::test
