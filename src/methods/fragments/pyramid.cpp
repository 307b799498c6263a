#include "methods/fragments/pyramid.h"

#include <algorithm>
#include <cmath>

#include "methods/fragments/pyramid_lanes.h"

namespace sightline {
namespace {}  // namespace

DiscontinuityPyramid::DiscontinuityPyramid() {
  for (int m = 0; m <= kRootLevel; ++m) {
    const std::size_t n = std::size_t{1} << (2 * (kRootLevel - m));
    kappa_[index(m)].resize(n), dz_[index(m)].resize(n), any_[index(m)].resize(n);
  }
}

// Level 0 compares a pixel with its right and its lower neighbour, so that a border between two squares is recorded in the upper left one.
void DiscontinuityPyramid::build(const GBuffer& g, const RootTile& tile, const GeometryOptions& options, std::uint8_t* flat) {
  std::fill(kappa_[0].begin(), kappa_[0].end(), 0.f), std::fill(dz_[0].begin(), dz_[0].end(), 0.f);
  std::fill(any_[0].begin(), any_[0].end(), std::uint8_t{0});
  for (int y = tile.y0; y < tile.y1; ++y) {
    const std::size_t to = at(0, 0, y - tile.y0);
    discontinuities(
        g, {g.at(tile.x0, y), static_cast<std::size_t>(tile.x1 - tile.x0), tile.x1 == g.width, y + 1 == g.height, options.plane_distance},
        kappa_[0].data() + to, dz_[0].data() + to, any_[0].data() + to, flat ? flat + g.at(tile.x0, y) : nullptr);
  }
  for (int m = 1; m <= kRootLevel; ++m) {
    const int size = kRootSize >> m;
    const auto greatest = [&](auto& levels, auto combine) {
      for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
          const auto* upper = levels[index(m - 1)].data() + at(m - 1, 2 * x, 2 * y);
          const auto* lower = levels[index(m - 1)].data() + at(m - 1, 2 * x, 2 * y + 1);
          levels[index(m)][at(m, x, y)] = combine(combine(upper[0], upper[1]), combine(lower[0], lower[1]));
        }
      }
    };
    greatest(kappa_, [](float a, float b) { return std::max(a, b); });
    greatest(dz_, [](float a, float b) { return std::max(a, b); });
    greatest(any_, [](std::uint8_t a, std::uint8_t b) { return static_cast<std::uint8_t>(a | b); });
  }
}

void DiscontinuityPyramid::refine(const GBuffer& g, const RootTile& tile, const GeometryOptions& options,
                                  std::vector<Fragment>& fragments) const {
  const int m = std::min(options.coarsest, kRootLevel), size = kRootSize >> m;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) refine(g, tile, options, m, x, y, fragments);
  }
}

void DiscontinuityPyramid::refine(const GBuffer& g, const RootTile& tile, const GeometryOptions& options, int m, int x, int y,
                                  std::vector<Fragment>& fragments) const {
  const int px = tile.x0 + (x << m), py = tile.y0 + (y << m);
  if (!any_[index(m)][at(m, x, y)] || px >= g.width || py >= g.height) return;
  const float kappa = curvature(m, x, y), dz = depth_change(m, x, y);
  // Depth alone never splits squares of two pixels, unless there is no surface beside it.
  const bool split = m > 0 && (kappa > options.tau_n || (dz > options.tau_d && m > 1) || dz == kInfinity);
  if (!split) {
    fragments.push_back({static_cast<std::uint16_t>(px), static_cast<std::uint16_t>(py), static_cast<std::uint8_t>(m)});
    return;
  }
  for (int q = 0; q < 4; ++q) refine(g, tile, options, m - 1, 2 * x + (q & 1), 2 * y + (q >> 1), fragments);
}

}  // namespace sightline
