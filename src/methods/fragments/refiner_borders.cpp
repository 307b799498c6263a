// Where the signal jumps between fragments.
#include <algorithm>
#include <cmath>

#include "base/math/vec3_batch.h"
#include "methods/fragments/refiner.h"

namespace sightline {
namespace {

constexpr int kPixelsLevel = 2;  // fragments up to this one become pixels at once where a border runs along them

}  // namespace

// Stable fragments beside which the signal jumps: the jump lies somewhere between their probes and the border. Small ones become pixels,
// large ones are tested again in smaller squares.
void Refiner::find_borders(const GBuffer& g, const LightSignal& signal, int round, TileProgress& progress) {
  const auto value_at = [&](int x, int y) {
    const int half = (1 << signal.level[g.at(x, y)]) / 2;
    return half == 0 ? signal.value[0][g.at(x, y)] : signal.value[0][g.at(x & -half, y & -half)];
  };
  const auto jumps = [&](int x, int y, int nx, int ny, float least) {
    if (!g.inside(x, y) || !g.inside(nx, ny)) return false;
    const std::size_t here = g.at(x, y), there = g.at(nx, ny);
    if (g.kind[here] != g.kind[there] || signal.flags[there] & LightSignal::kUnlit) return false;
    if (std::fabs(value_at(x, y) - value_at(nx, ny)) < least) return false;
    const Vec3 normal = load(g.geometric_normal, here);
    return glm::dot(load(g.shading_normal, here), load(g.shading_normal, there)) > 0.9f &&
           std::fabs(glm::dot(load(g.position, there) - load(g.position, here), normal)) < 0.01f * g.depth[here];
  };
  // What has been looked at is looked at again only if the last round changed it, or something beside it.
  const auto changed = [&](const Fragment& f) {
    constexpr int kBlock = LightSignal::kBlock;
    const int x1 = std::min(f.x + f.width(), g.width - 1), y1 = std::min(f.y + f.width(), g.height - 1);
    for (int y = std::max(f.y - 1, 0) & -kBlock; y <= y1; y += kBlock)
      for (int x = std::max(f.x - 1, 0) & -kBlock; x <= x1; x += kBlock)
        if (signal.round_at(x, y) + 1 == round) return true;
    return false;
  };
  std::size_t kept = 0;
  for (const Fragment& f : progress.done) {
    if (round > 1 && !changed(f)) {
      progress.done[kept++] = f;
      continue;
    }
    const int w = f.width();
    // All or nothing by 16 rays may be nearly so: what lies beside it tells.
    const float own = value_at(f.x, f.y);
    const bool saturated = (own == 0 || own == 1) && value_at(f.x + w / 2, f.y) == own && value_at(f.x, f.y + w / 2) == own &&
                           value_at(f.x + w / 2, f.y + w / 2) == own;
    const float least = saturated ? options_.border_jump_saturated : options_.border_jump;
    bool jump = false;
    for (int i = 0; i < w && !jump; ++i) {
      jump = jumps(f.x + i, f.y, f.x + i, f.y - 1, least) || jumps(f.x + i, f.y + w - 1, f.x + i, f.y + w, least) ||
             jumps(f.x, f.y + i, f.x - 1, f.y + i, least) || jumps(f.x + w - 1, f.y + i, f.x + w, f.y + i, least);
    }
    if (!jump) {
      progress.done[kept++] = f;
      continue;
    }
    --counts_.fragments;
    if (f.level > kPixelsLevel) {
      subdivide(f, 0, progress.children);
      continue;
    }
    for (int y = f.y; y < f.y + w; ++y) {
      for (int x = f.x; x < f.x + w; ++x) progress.children.push_back({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y), 0});
    }
  }
  progress.done.resize(kept);
}

}  // namespace sightline
