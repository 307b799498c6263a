#include "methods/fragments/edges.h"

#include <array>
#include <cmath>

#include "base/math/vec3_batch.h"

namespace sightline {
namespace {

constexpr float kEdgeCosine = 0.9f;
constexpr float kEdgeDistance = 0.005f;  // relative to depth

bool differ(const GBuffer& g, std::size_t a, std::size_t b, const GeometryOptions& options) {
  if (g.kind[a] != g.kind[b]) return true;
  if (g.kind[a] == PixelKind::background) return false;
  const Vec3 bend = load(g.shading_normal, b) - load(g.shading_normal, a);
  if (glm::dot(bend, bend) > options.tau_n * options.tau_n) return true;
  const float away =
      options.plane_distance ? glm::dot(load(g.position, b) - load(g.position, a), load(g.geometric_normal, a)) : g.depth[b] - g.depth[a];
  return std::fabs(away) > options.tau_d * g.depth[a];
}

}  // namespace

void edge_pixels(const GBuffer& g, const RootTile& tile, const GeometryOptions& options, std::vector<std::uint32_t>& pixels) {
  // Whether a pixel of the row above differs from the one below it.
  std::array<bool, kRootSize> above{}, below{};
  const auto across_rows = [&](int y, std::array<bool, kRootSize>& differs) {
    for (int x = tile.x0; x < tile.x1; ++x)
      differs[static_cast<std::size_t>(x - tile.x0)] = y >= 0 && y + 1 < g.height && differ(g, g.at(x, y), g.at(x, y + 1), options);
  };
  across_rows(tile.y0 - 1, above);
  for (int y = tile.y0; y < tile.y1; ++y, above = below) {
    across_rows(y, below);
    bool left = tile.x0 > 0 && differ(g, g.at(tile.x0 - 1, y), g.at(tile.x0, y), options);
    for (int x = tile.x0; x < tile.x1; ++x) {
      const auto i = static_cast<std::size_t>(x - tile.x0);
      const bool right = x + 1 < g.width && differ(g, g.at(x, y), g.at(x + 1, y), options);
      if (left || right || above[i] || below[i]) pixels.push_back(static_cast<std::uint32_t>(g.at(x, y)));
      left = right;
    }
  }
}

std::uint32_t same_surface_near(const GBuffer& g, std::uint32_t pixel, const GBuffer& points, std::size_t point) {
  const auto stride = static_cast<std::uint32_t>(g.stride);
  const int x = static_cast<int>(pixel % stride), y = static_cast<int>(pixel / stride);
  const Vec3 position = load(points.position, point), normal = load(points.shading_normal, point);
  const Vec3 facet = load(points.geometric_normal, point);
  std::uint32_t nearest = kNoPixel;
  float least = 0;
  for (int ny = y - 1; ny <= y + 1; ++ny) {
    for (int nx = x - 1; nx <= x + 1; ++nx) {
      if (!g.inside(nx, ny)) continue;
      const std::size_t at = g.at(nx, ny);
      if (g.kind[at] != points.kind[point] || glm::dot(load(g.shading_normal, at), normal) < kEdgeCosine) continue;
      const Vec3 d = load(g.position, at) - position;
      if (std::fabs(glm::dot(d, facet)) > kEdgeDistance * points.depth[point]) continue;
      const float squared = glm::dot(d, d);
      if (nearest == kNoPixel || squared < least) nearest = static_cast<std::uint32_t>(at), least = squared;
    }
  }
  return nearest;
}

}  // namespace sightline
