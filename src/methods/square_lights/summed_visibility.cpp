#include "methods/square_lights/summed_visibility.h"

#include <algorithm>
#include <array>

#include "base/core/grid_index.h"
#include "methods/square_lights/hemisphere_disk.h"

namespace sightline::square_lights {
namespace {

constexpr int kTableCorners = kTableSize + 1;
using CornerSums = std::array<float, std::size_t{kTableCorners} * kTableCorners>;

/// Integrals over all cells left of and above each corner, in cells.
void sum_up(TableView table, CornerSums& corners) {
  corners.fill(0);
  constexpr float cell = 2.f / kTableSize;
  for (int y = 0; y < kTableSize; ++y) {
    float row = 0;
    for (int x = 0; x < kTableSize; ++x) {
      const float d = decode_distance(table[grid_index(x, y, kTableSize)]);
      row += std::clamp(0.5f + d / cell, 0.f, 1.f);
      const auto at = grid_index(x + 1, y + 1, kTableCorners);
      corners[at] = corners[at - kTableCorners] + row;
    }
  }
}

float corner_at(const CornerSums& corners, float x, float y) {
  const float gx = std::clamp((x + 1) * 0.5f * kTableSize, 0.f, float{kTableSize}),
              gy = std::clamp((y + 1) * 0.5f * kTableSize, 0.f, float{kTableSize});
  const int ix = std::min(static_cast<int>(gx), kTableSize - 1), iy = std::min(static_cast<int>(gy), kTableSize - 1);
  const float tx = gx - static_cast<float>(ix), ty = gy - static_cast<float>(iy);
  const auto at = grid_index(ix, iy, kTableCorners);
  return (1 - ty) * ((1 - tx) * corners[at] + tx * corners[at + 1]) +
         ty * ((1 - tx) * corners[at + kTableCorners] + tx * corners[at + kTableCorners + 1]);
}

}  // namespace

void summed_visibility(const ReceiverTables& tables, const LightSet& lights, float plane_scale, std::span<float> visible) {
  std::fill(visible.begin(), visible.end(), 0.f);
  CornerSums corners;
  for (int j = 0; j < tables.count; ++j) {
    sum_up(TableView(tables.table[j], kTableCells), corners);
    for (std::size_t i = 0; i < lights.count; ++i) {
      const Vec2 p = disk_from_direction(tables.frame[j].to_local({lights.x[i], lights.y[i], lights.z[i]}));
      const float h = 0.70710678f * plane_scale * lights.r[i];
      // Of squares that leave the table, the part inside counts.
      const float left = std::max(p.x - h, -1.f), right = std::min(p.x + h, 1.f), top = std::max(p.y - h, -1.f),
                  bottom = std::min(p.y + h, 1.f);
      if (!(left < right && top < bottom)) continue;
      const float area = (right - left) * (bottom - top) * (0.25f * kTableSize * kTableSize);
      const float sum = corner_at(corners, right, bottom) - corner_at(corners, left, bottom) - corner_at(corners, right, top) +
                        corner_at(corners, left, top);
      visible[i] += tables.weight[j] * std::clamp(sum / area, 0.f, 1.f);
    }
  }
}

}  // namespace sightline::square_lights
