#include "methods/square_lights/texel_exchange.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "methods/square_lights/region_sums.h"

namespace sightline::square_lights {
namespace {

constexpr int kMostSweeps = 100;
// A sweep that gains less is the last.
constexpr double kLeastGain = 1e-6;

class Exchanger {
 public:
  Exchanger(const LightCube& cube, const MergeTree& tree, std::size_t count) : texels_(cube.count()), owner_(cube.count()) {
    for (std::size_t t = 0; t < texels_.size(); ++t) texels_[t] = RegionSums(cube.center(t), cube.solid_angle(t), cube.texels[t]);
    link(cube);
    const std::vector<std::int32_t> cut = tree.cut(count);
    regions_.resize(cut.size()), size_.resize(cut.size());
    for (std::size_t r = 0; r < cut.size(); ++r) own(tree, cut[r], static_cast<std::uint32_t>(r));
  }

  TexelExchange run() {
    TexelExchange result;
    result.before = result.after = error();
    result.region = owner_;
    while (result.sweeps < kMostSweeps && sweep()) {
      ++result.sweeps;
      // Centres move between sweeps, and are those of luminance where the error is of all channels: it need not fall for ever.
      const double now = error();
      if (!(now < result.after)) break;
      const bool done = now > (1 - kLeastGain) * result.after;
      result.after = now, result.region = owner_;
      if (done) break;
    }
    std::vector<RegionSums> sums(regions_.size());
    for (std::size_t t = 0; t < texels_.size(); ++t) sums[result.region[t]] += texels_[t];
    for (const RegionSums& region : sums) result.lights.push_back(region.light());
    return result;
  }

 private:
  void own(const MergeTree& tree, std::int32_t top, std::uint32_t region) {
    std::vector<std::int32_t> open{top};
    while (!open.empty()) {
      const auto id = static_cast<std::size_t>(open.back());
      open.pop_back();
      if (id < texels_.size()) {
        owner_[id] = region, regions_[region] += texels_[id], ++size_[region];
      } else {
        open.push_back(tree.nodes()[id].left), open.push_back(tree.nodes()[id].right);
      }
    }
  }

  /// Four neighbours of each texel: one step beyond an edge the direction leads onto the neighbouring face.
  void link(const LightCube& cube) {
    const int n = cube.size;
    neighbours_.resize(cube.count());
    for (std::size_t t = 0; t < cube.count(); ++t) {
      const int place = static_cast<int>(t), face = place / (n * n), x = place % n, y = place / n % n;
      const auto step = [&](int dx, int dy) {
        return static_cast<std::uint32_t>(cube.texel_of(cube_direction(face, cube_coordinate(x + dx, n), cube_coordinate(y + dy, n))));
      };
      neighbours_[t] = {step(1, 0), step(-1, 0), step(0, 1), step(0, -1)};
    }
  }

  double error() const {
    double sum = 0;
    for (const RegionSums& region : regions_) sum += region.error();
    return sum;
  }

  /// How much more (F + f) (S + s) is than F S, with F the flux of a region and S its spread, f and s those of a texel from the region's
  /// centre; summed over channels. `inside`: the texel is part of the region's sums already.
  double cost(std::size_t t, std::uint32_t r, bool inside) const {
    double sum = 0;
    for (int c = 0; c < 3; ++c) {
      const double f = texels_[t].flux[c], s = texels_[t].spread(c, centers_[r]);
      const double flux = regions_[r].flux[c] - (inside ? f : 0), spread = regions_[r].spread(c, centers_[r]) - (inside ? s : 0);
      sum += kChannelWeight[static_cast<std::size_t>(c)] * (flux * s + f * spread + f * s);
    }
    return sum;
  }

  /// Whether any texel moved. Centres stay until the sweep is over, sums do not.
  bool sweep() {
    centers_.clear();
    for (const RegionSums& region : regions_) centers_.push_back(region.center());
    bool moved = false;
    for (std::size_t t = 0; t < texels_.size(); ++t) {
      const std::uint32_t from = owner_[t];
      if (size_[from] == 1) continue;
      const auto stays = [&](std::uint32_t neighbour) { return owner_[neighbour] == from; };
      if (std::ranges::all_of(neighbours_[t], stays)) continue;
      std::uint32_t best = from;
      double least = cost(t, from, true);
      for (const std::uint32_t neighbour : neighbours_[t]) {
        const std::uint32_t to = owner_[neighbour];
        if (to == from || to == best) continue;
        const double added = cost(t, to, false);
        if (added < (1 - 1e-9) * least) best = to, least = added;
      }
      if (best == from) continue;
      regions_[from] -= texels_[t], --size_[from];
      regions_[best] += texels_[t], ++size_[best];
      owner_[t] = best, moved = true;
    }
    return moved;
  }

  std::vector<RegionSums> texels_, regions_;
  std::vector<std::array<std::uint32_t, 4>> neighbours_;
  std::vector<std::uint32_t> owner_, size_;
  std::vector<Vec3d> centers_;
};

}  // namespace

TexelExchange exchange_texels(const LightCube& cube, const MergeTree& tree, std::size_t count) {
  return Exchanger(cube, tree, count).run();
}

}  // namespace sightline::square_lights
