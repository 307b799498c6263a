#include "methods/square_lights/distance_table.h"

#include <cassert>
#include <limits>

#include "base/core/aligned.h"

namespace sightline::square_lights {
namespace {

struct Cell {
  int x, y;      ///< lower corner of the four
  float fx, fy;  ///< place between them
};
Cell cell_at(const Vec2& p) {
  constexpr float last = kTableSize - 1, half = kTableSize / 2.f;
  const float u = std::clamp(p.x * half + (half - 0.5f), 0.f, last), v = std::clamp(p.y * half + (half - 0.5f), 0.f, last);
  const int x = std::min(static_cast<int>(u), kTableSize - 2), y = std::min(static_cast<int>(v), kTableSize - 2);
  return {x, y, u - static_cast<float>(x), v - static_cast<float>(y)};
}

/// Area of the unit-area square's part below a line at signed distance d, for a square whose edges' halves are `a` >= `b` >= 0 along the
/// line's normal: the integral of a trapezoid.
float covered_part(float a, float b, float d) {
  const float distance = std::fabs(d);
  float covered = 1;
  if (distance <= a - b) {
    covered = 0.5f + distance / (2 * a);
  } else if (distance < a + b) {
    const float left = a + b - distance;
    covered = 1 - left * left / (8 * a * b);
  }
  return d < 0 ? 1 - covered : covered;
}

}  // namespace

float distance_at(TableView table, const Vec2& p) {
  const Cell cell = cell_at(p);
  const std::int8_t* const corner = table.data() + cell.y * kTableSize + cell.x;
  const auto between = [](float t, float a, float b) { return a + t * (b - a); };
  const float top = between(cell.fx, corner[0], corner[1]), bottom = between(cell.fx, corner[kTableSize], corner[kTableSize + 1]);
  return decode_distance(between(cell.fy, top, bottom));
}

float distance_at(TableView table, const Vec2& p, Vec2& gradient) {
  const Cell cell = cell_at(p);
  const std::int8_t* const corner = table.data() + cell.y * kTableSize + cell.x;
  const float c00 = corner[0], c10 = corner[1], c01 = corner[kTableSize], c11 = corner[kTableSize + 1];
  constexpr float codes_per_cell = kDistanceStep * kTableSize / 2;
  gradient = {((1 - cell.fy) * (c10 - c00) + cell.fy * (c11 - c01)) * codes_per_cell,
              ((1 - cell.fx) * (c01 - c00) + cell.fx * (c11 - c10)) * codes_per_cell};
  return distance_at(table, p);
}

const std::array<float, kAverageCoverages>& average_coverages() {
  static const std::array<float, kAverageCoverages> table = [] {
    std::array<float, kAverageCoverages> means{};
    for (std::size_t i = 0; i < means.size(); ++i) {
      // The square looks the same after an eighth of a turn and a reflection. Midpoints: the integrand is smooth.
      constexpr int turns = 256;
      double sum = 0;
      for (int k = 0; k < turns; ++k) {
        const double turn = (k + 0.5) * std::numbers::pi / (4 * turns);
        const double half_edge = std::numbers::sqrt2 / 2;
        sum += covered_part(static_cast<float>(half_edge * std::cos(turn)), static_cast<float>(half_edge * std::sin(turn)),
                            static_cast<float>(i) / (kAverageCoverages - 1));
      }
      means[i] = static_cast<float>(sum / turns);
    }
    return means;
  }();
  return table;
}

float covered_average(float d, float r_p) {
  constexpr float last = kAverageCoverages - 1;
  const auto& table = average_coverages();
  const float u = std::min(std::fabs(d) / std::max(r_p, 1e-12f) * last, last);
  const std::size_t i = std::min(static_cast<std::size_t>(u), kAverageCoverages - 2);
  const float covered = table[i] + (u - static_cast<float>(i)) * (table[i + 1] - table[i]);
  return d < 0 ? 1 - covered : covered;
}

float covered_gradient(float d, const Vec2& normal, float r_p) {
  const float length = std::sqrt(normal.x * normal.x + normal.y * normal.y);
  if (!(length > 1e-6f)) return covered_average(d, r_p);
  const float half_edge = 0.70710678f * std::max(r_p, 1e-12f) / length;
  const float x = std::fabs(normal.x) * half_edge, y = std::fabs(normal.y) * half_edge;
  return covered_part(std::max(x, y), std::min(x, y), d);
}

DiskGrid::DiskGrid(int n) : n_(n), inside_(static_cast<std::size_t>(n) * n) {
  assert(n % kTableSize == 0 && n > 0);
  const auto is_inside = [this](std::size_t i) {
    const Vec2 p = point(i);
    return p.x * p.x + p.y * p.y <= 1;
  };
  // Only points of the disk that have a neighbour outside can be nearest to one outside.
  std::vector<std::uint32_t> rim;
  for (std::size_t i = 0; i < inside_.size(); ++i) {
    const Vec2 p = point(i);
    if (is_inside(i) && std::sqrt(p.x * p.x + p.y * p.y) + 4 / static_cast<float>(n) > 1) rim.push_back(static_cast<std::uint32_t>(i));
  }
  for (std::size_t i = 0; i < inside_.size(); ++i) {
    inside_[i] = static_cast<std::uint32_t>(i);
    if (is_inside(i)) continue;
    float least = std::numeric_limits<float>::infinity();
    for (const std::uint32_t j : rim) {
      const Vec2 way = point(j) - point(i);
      const float distance = way.x * way.x + way.y * way.y;
      if (distance < least) least = distance, inside_[i] = j;
    }
  }
}

Vec2 DiskGrid::point(std::size_t i) const {
  const std::size_t n = static_cast<std::size_t>(n_);
  const float cell = 2 / static_cast<float>(n_);
  const std::size_t x = i % n, y = i / n;
  return {(static_cast<float>(x) + 0.5f) * cell - 1, (static_cast<float>(y) + 0.5f) * cell - 1};
}

void fill_outside(const DiskGrid& grid, bool count_horizon, std::span<std::uint8_t> visible) {
  const std::span<const std::uint32_t> nearest = grid.nearest_inside();
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    if (count_horizon) {
      if (nearest[i] != i) visible[i] = 0;
    } else {
      visible[i] = visible[nearest[i]];
    }
  }
}

void make_distance_table(std::span<const std::uint8_t> visible, int n, std::span<std::int8_t, kTableCells> table) {
  // Most open points have no boundary at all.
  if (std::all_of(visible.begin(), visible.end(), [&](std::uint8_t v) { return v == visible.front(); })) {
    std::fill(table.begin(), table.end(), encode_distance(visible.front() ? 2.f : -2.f));
    return;
  }
  AlignedVector<float> distances(visible.size());
  signed_distances(visible, n, distances);
  const int fold = n / kTableSize;
  // From cells of the map to plane units, and the mean of fold x fold of them.
  const float scale = 2 / (static_cast<float>(n) * static_cast<float>(fold * fold) * kDistanceStep);
  for (int y = 0; y < kTableSize; ++y) {
    for (int x = 0; x < kTableSize; ++x) {
      const float* const first = distances.data() + (y * n + x) * fold;
      float sum = 0;
      for (int j = 0; j < fold; ++j) {
        for (int i = 0; i < fold; ++i) sum += first[j * n + i];
      }
      const float code = std::clamp(sum * scale, -127.f, 127.f);
      table[y * kTableSize + x] = static_cast<std::int8_t>(static_cast<int>(code + (code < 0 ? -0.5f : 0.5f)));
    }
  }
}

}  // namespace sightline::square_lights
