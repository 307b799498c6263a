#include "methods/fragments/stage_map.h"

#include <algorithm>
#include <bit>

namespace sightline {
namespace {

// Jumps between surfaces are infinite.
constexpr float kGreatestChange = 8;

struct Rows {
  int x0, y0, x1, y1;
  int pixels() const { return std::max(x1 - x0, 0) * std::max(y1 - y0, 0); }
};
Rows rows_of(const GBuffer& g, const Fragment& f) {
  return {f.x, f.y, std::min(f.x + f.width(), g.width), std::min(f.y + f.width(), g.height)};
}

}  // namespace

void StageMap::begin(const GBuffer& g) {
  first_.assign(g.element_count(), 0.f);
  if (wants_curvature()) second_.assign(g.element_count(), 0.f);
}

void StageMap::add_rays(const GBuffer& g, const Fragment& f, std::uint32_t rays) {
  const Rows rows = rows_of(g, f);
  if (rows.pixels() == 0) return;
  const float share = static_cast<float>(rays) / (kRaysPerUnit * static_cast<float>(rows.pixels()));
  for (int y = rows.y0; y < rows.y1; ++y) {
    for (int x = rows.x0; x < rows.x1; ++x) first_[g.at(x, y)] += share;
  }
}

void StageMap::set_gradient(const GBuffer& g, const Fragment& f, float gradient) {
  const Rows rows = rows_of(g, f);
  for (int y = rows.y0; y < rows.y1; ++y) std::fill_n(first_.data() + g.at(rows.x0, y), rows.x1 - rows.x0, gradient);
}

void StageMap::set_geometry(const GBuffer& g, const RootTile& tile, const DiscontinuityPyramid& pyramid, const GeometryOptions& options) {
  const auto in_units = [](float change, float threshold) { return std::min(change / std::max(threshold, 1e-6f), kGreatestChange); };
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      first_[g.at(x, y)] = in_units(pyramid.curvature(0, x - tile.x0, y - tile.y0), options.tau_n);
      second_[g.at(x, y)] = in_units(pyramid.depth_change(0, x - tile.x0, y - tile.y0), options.tau_d);
    }
  }
}

float steepest_gradient(const ProbeMasks& masks, std::uint32_t points) {
  int steepest = 0;
  for (const auto& [p, q] : kNeighbours) steepest = std::max(steepest, std::popcount(masks[p] ^ masks[q]));
  return static_cast<float>(steepest) / static_cast<float>(points);
}

}  // namespace sightline
