#include "methods/square_lights/components.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "methods/square_lights/table_lanes.h"

namespace sightline::square_lights {
namespace {

// Vectors beyond those wanted: convergence depends on the gap between the last wanted eigenvalue and the first that is not carried along.
constexpr std::size_t kSpare = 8;

double dot(const float* a, const float* b) {
  // Several sums: one alone waits for each addition.
  std::array<double, 8> sums{};
  for (std::size_t i = 0; i < kTableCells; i += sums.size()) {
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += static_cast<double>(a[i + k]) * b[i + k];
  }
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

/// Gram-Schmidt over rows, each twice; rows that depend on earlier ones become 0.
void orthonormalize(AlignedVector<float>& rows, std::size_t count) {
  for (std::size_t j = 0; j < count; ++j) {
    float* const row = rows.data() + j * kTableCells;
    const double before = std::sqrt(dot(row, row));
    for (int pass = 0; pass < 2; ++pass) {
      for (std::size_t k = 0; k < j; ++k) {
        const float* const other = rows.data() + k * kTableCells;
        const auto part = static_cast<float>(dot(row, other));
        for (std::size_t i = 0; i < kTableCells; ++i) row[i] -= part * other[i];
      }
    }
    const double length = std::sqrt(dot(row, row));
    const float scale = length > 1e-7 * before ? static_cast<float>(1 / length) : 0;
    for (std::size_t i = 0; i < kTableCells; ++i) row[i] *= scale;
  }
}

/// Eigenvectors of a small symmetric matrix by Jacobi's rotations: columns of `vectors`, eigenvalues on the diagonal of `a`.
void jacobi(std::vector<double>& a, std::vector<double>& vectors, std::size_t n) {
  vectors.assign(n * n, 0);
  for (std::size_t i = 0; i < n; ++i) vectors[i * n + i] = 1;
  for (int sweep = 0; sweep < 50; ++sweep) {
    double off = 0, all = 0;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) (i == j ? all : off) += a[i * n + j] * a[i * n + j];
    }
    if (off <= 1e-24 * all) return;
    for (std::size_t p = 0; p + 1 < n; ++p) {
      for (std::size_t q = p + 1; q < n; ++q) {
        if (a[p * n + q] == 0) continue;
        const double theta = (a[q * n + q] - a[p * n + p]) / (2 * a[p * n + q]);
        const double t = std::copysign(1.0, theta) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (std::size_t k = 0; k < n; ++k) {
          const double x = a[k * n + p], y = a[k * n + q];
          a[k * n + p] = c * x - s * y, a[k * n + q] = s * x + c * y;
        }
        for (std::size_t k = 0; k < n; ++k) {
          const double x = a[p * n + k], y = a[q * n + k];
          a[p * n + k] = c * x - s * y, a[q * n + k] = s * x + c * y;
          const double u = vectors[k * n + p], v = vectors[k * n + q];
          vectors[k * n + p] = c * u - s * v, vectors[k * n + q] = s * u + c * v;
        }
      }
    }
  }
}

/// Numbers without a pattern, the same on every run, to start from.
void fill_pattern(float* row, std::uint32_t seed) {
  std::uint32_t state = seed * 2654435761u + 12345u;
  for (std::size_t i = 0; i < kTableCells; ++i) {
    state = state * 1664525u + 1013904223u;
    row[i] = static_cast<float>(state >> 8) * 0x1p-23f - 1;
  }
}

/// One of the tables from the span, one member after another.
struct Members {
  std::span<const std::int8_t> tables;
  std::span<const std::uint32_t> numbers;
  const std::int8_t* operator[](std::size_t i) const { return tables.data() + std::size_t{numbers[i]} * kTableCells; }
  std::size_t size() const { return numbers.size(); }
};

/// Turns the rows so that each is the best of those that follow (Rayleigh and Ritz).
void rotate_to_eigenvectors(const Members& members, const AlignedVector<float>& mean, AlignedVector<float>& rows, std::size_t count) {
  std::vector<double> gram(count * count, 0), turn;
  AlignedVector<float> dots(count);
  for (std::size_t i = 0; i < members.size(); ++i) {
    project_table(members[i], mean.data(), rows.data(), count, dots.data());
    for (std::size_t j = 0; j < count; ++j) {
      for (std::size_t k = 0; k < count; ++k) gram[j * count + k] += static_cast<double>(dots[j]) * dots[k];
    }
  }
  jacobi(gram, turn, count);
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return gram[a * count + a] > gram[b * count + b]; });
  AlignedVector<float> turned(count * kTableCells, 0.f);
  for (std::size_t j = 0; j < count; ++j) {
    for (std::size_t k = 0; k < count; ++k) {
      const auto part = static_cast<float>(turn[k * count + order[j]]);
      for (std::size_t i = 0; i < kTableCells; ++i) turned[j * kTableCells + i] += part * rows[k * kTableCells + i];
    }
  }
  rows = std::move(turned);
}

}  // namespace

void fit_components(std::span<const std::int8_t> tables, std::span<const std::uint32_t> numbers, std::size_t count, int sweeps,
                    Components& components) {
  const Members members{tables, numbers};
  // The mean, exactly: sums of codes are whole numbers.
  std::vector<std::int32_t> sum(kTableCells, 0);
  for (std::size_t i = 0; i < members.size(); ++i) {
    const std::int8_t* const table = members[i];
    for (std::size_t c = 0; c < kTableCells; ++c) sum[c] += table[c];
  }
  components.mean.resize(kTableCells);
  for (std::size_t c = 0; c < kTableCells; ++c)
    components.mean[c] = static_cast<float>(static_cast<double>(sum[c]) / static_cast<double>(std::max<std::size_t>(members.size(), 1)));

  const std::size_t carried = std::min(count + kSpare, members.size());
  AlignedVector<float> rows = std::move(components.vectors);
  components.vectors.assign(count * kTableCells, 0.f);
  if (count == 0 || carried == 0) return;
  const std::size_t given = std::min(rows.size() / kTableCells, carried);
  rows.resize(carried * kTableCells);
  for (std::size_t j = 0; j < carried; ++j) {
    float* const row = rows.data() + j * kTableCells;
    const bool unused = j >= given || std::all_of(row, row + kTableCells, [](float v) { return v == 0; });
    if (unused) fill_pattern(row, static_cast<std::uint32_t>(j));
  }
  orthonormalize(rows, carried);

  AlignedVector<float> next, dots(carried);
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    // Covariance times rows, without the covariance: through each table in turn.
    next.assign(rows.size(), 0.f);
    for (std::size_t i = 0; i < members.size(); ++i) {
      project_table(members[i], components.mean.data(), rows.data(), carried, dots.data());
      add_projected(members[i], components.mean.data(), dots.data(), carried, next.data());
    }
    std::swap(rows, next);
    orthonormalize(rows, carried);
  }
  rotate_to_eigenvectors(members, components.mean, rows, carried);
  std::copy_n(rows.begin(), std::min(count, carried) * kTableCells, components.vectors.begin());
}

}  // namespace sightline::square_lights
