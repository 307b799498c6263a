#include "methods/fragments/upsample_cells.h"

#include <algorithm>
#include <bit>

#include "base/math/vec3_batch.h"

namespace sightline {
namespace {

// Two points of one surface: normals within 26 degrees, and neither further from the other's tangent plane than a fiftieth of their
// depth. A cylinder whose normals turn by 26 degrees leaves its chord by 13: the slope of the chord tells a step of a stair, however low,
// from a curve.
constexpr float kSurfaceCosine = 0.9f;
constexpr float kSurfaceDistance = 0.02f;
constexpr float kSurfaceSlope = 0.35f;

}  // namespace

SignalSample SignalCells::sample(const Cell& cell) const {
  SignalSample result{.x = static_cast<float>(cell.x) + 0.5f * static_cast<float>(cell.size),
                      .y = static_cast<float>(cell.y) + 0.5f * static_cast<float>(cell.size),
                      .width = cell.size,
                      .level = std::countr_zero(static_cast<unsigned>(cell.size))};
  if (quadrants_ || cell.size == 1) {
    const std::size_t i = g_.at(cell.x, cell.y);
    for (std::size_t c = 0; c < static_cast<std::size_t>(channels()); ++c) result.value[c] = signal_.value[c][i];
    return result;
  }
  // Quadrants beyond the picture's edge have no value; the mean of the others stands for where these lie.
  const int half = cell.size / 2, columns = cell.x + half < g_.width ? 2 : 1, rows = cell.y + half < g_.height ? 2 : 1;
  const float share = 1 / static_cast<float>(columns * rows);
  if (columns == 1) result.x -= 0.5f * static_cast<float>(half);
  if (rows == 1) result.y -= 0.5f * static_cast<float>(half);
  for (std::size_t c = 0; c < static_cast<std::size_t>(channels()); ++c) {
    float sum = 0;
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i) sum += signal_.value[c][g_.at(cell.x + i * half, cell.y + j * half)];
    result.value[c] = share * sum;
  }
  return result;
}

SignalSample SignalCells::extra(int x, int y) const {
  SignalSample result{.x = static_cast<float>(x) + 0.5f, .y = static_cast<float>(y) + 0.5f};
  for (std::size_t c = 0; c < static_cast<std::size_t>(channels()); ++c) result.value[c] = signal_.extra[c][g_.at(x, y)];
  return result;
}

bool SignalCells::connected(std::size_t a, std::size_t b) const {
  if (glm::dot(load(g_.shading_normal, a), load(g_.shading_normal, b)) < kSurfaceCosine) return false;
  const Vec3 d = load(g_.position, b) - load(g_.position, a);
  const float distance = std::max(std::abs(glm::dot(d, load(g_.geometric_normal, a))), std::abs(glm::dot(d, load(g_.geometric_normal, b))));
  return distance <= kSurfaceDistance * std::max(g_.depth[a], g_.depth[b]) &&
         distance * distance <= kSurfaceSlope * kSurfaceSlope * length_squared(d);
}

}  // namespace sightline
