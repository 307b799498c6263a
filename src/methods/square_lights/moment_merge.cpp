#include "methods/square_lights/moment_merge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <queue>
#include <tuple>

#include "methods/square_lights/region_moments.h"
#include "methods/square_lights/region_sums.h"
#include "methods/square_lights/square_fit.h"

namespace sightline::square_lights {
namespace {

class MomentMerger {
 public:
  MomentMerger(const LightCube& cube, const MergeOptions& options) : cube_(cube), options_(options) {
    const std::size_t count = cube.count();
    nodes_.reserve(2 * count - 1);
    regions_.resize(2 * count - 1);
    for (std::size_t i = 0; i < count; ++i) {
      Region& region = regions_[i];
      region.sums = RegionSums(cube.center(i), cube.solid_angle(i), cube.texels[i]);
      region.error = region.sums.error();
      region.texels = {static_cast<std::uint32_t>(i)};
      add_node(region, -1, -1);
    }
    link_texels();
  }

  std::vector<MergeNode> run(const Context& context) {
    while (!heap_.empty()) {
      const Pair pair = heap_.top();
      heap_.pop();
      if (regions_[pair.a].texels.empty() || regions_[pair.b].texels.empty()) continue;
      merge(pair);
      if (nodes_.size() % 256 == 0) context.check_cancelled();
    }
    return std::move(nodes_);
  }

 private:
  struct Region {
    RegionSums sums;
    double error = 0;
    std::vector<std::uint32_t> texels, neighbours;  // no texels: gone
  };
  struct Pair {
    double key;
    std::uint32_t a, b;  // a < b
    bool operator>(const Pair& other) const { return std::tie(key, a, b) > std::tie(other.key, other.a, other.b); }
  };

  /// Four neighbours of each texel, on other faces too.
  void link_texels() {
    const int n = cube_.size;
    for (std::size_t i = 0; i < cube_.count(); ++i) {
      const auto texels = static_cast<std::size_t>(n) * static_cast<std::size_t>(n);
      const int face = static_cast<int>(i / texels), x = static_cast<int>(i % texels) % n, y = static_cast<int>(i % texels) / n;
      for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        // One step beyond an edge the direction leads onto the neighbour's border.
        link(i, cube_.texel_of(cube_direction(face, cube_coordinate(x + dx, n), cube_coordinate(y + dy, n))));
      }
    }
  }

  void link(std::size_t a, std::size_t b) {
    std::vector<std::uint32_t>&of_a = regions_[a].neighbours, &of_b = regions_[b].neighbours;
    if (a == b || std::find(of_a.begin(), of_a.end(), b) != of_a.end()) return;
    of_a.push_back(static_cast<std::uint32_t>(b));
    of_b.push_back(static_cast<std::uint32_t>(a));
    push(static_cast<std::uint32_t>(std::min(a, b)), static_cast<std::uint32_t>(std::max(a, b)));
  }

  void push(std::uint32_t a, std::uint32_t b) {
    const double merged = (regions_[a].sums + regions_[b].sums).error();
    heap_.push({merged - regions_[a].error - regions_[b].error, a, b});
  }

  void merge(const Pair& pair) {
    const auto id = static_cast<std::uint32_t>(nodes_.size());
    Region &a = regions_[pair.a], &b = regions_[pair.b], &merged = regions_[id];
    merged.sums = a.sums + b.sums;
    merged.error = merged.sums.error();
    std::merge(a.texels.begin(), a.texels.end(), b.texels.begin(), b.texels.end(), std::back_inserter(merged.texels));
    std::sort(a.neighbours.begin(), a.neighbours.end());
    std::sort(b.neighbours.begin(), b.neighbours.end());
    std::set_union(a.neighbours.begin(), a.neighbours.end(), b.neighbours.begin(), b.neighbours.end(),
                   std::back_inserter(merged.neighbours));
    const auto gone = [&pair](std::uint32_t n) { return n == pair.a || n == pair.b; };
    std::erase_if(merged.neighbours, gone);
    a = {}, b = {};
    add_node(merged, static_cast<std::int32_t>(pair.a), static_cast<std::int32_t>(pair.b));
    for (const std::uint32_t n : merged.neighbours) {
      std::erase_if(regions_[n].neighbours, gone);
      regions_[n].neighbours.push_back(id);
      push(n, id);
    }
  }

  void add_node(const Region& region, std::int32_t left, std::int32_t right) {
    MergeNode node;
    node.light = region.sums.light();
    node.solid_angle = static_cast<float>(region.sums.area);
    node.left = left, node.right = right;
    set_moments(
        node, region.texels, [this](std::uint32_t t) { return cube_.solid_angle(t); }, [this](std::uint32_t t) { return cube_.texels[t]; });
    fitter_.clear();
    for (const std::uint32_t t : region.texels) fitter_.add(cube_.center(t), cube_.solid_angle(t), cube_.texels[t]);
    node.error = static_cast<float>(std::max(0.0, fitter_.error(node.light.center, node.light.radius, options_.area_penalty)));
    nodes_.push_back(node);
  }

  const LightCube& cube_;
  MergeOptions options_;
  std::vector<MergeNode> nodes_;
  std::vector<Region> regions_;
  std::priority_queue<Pair, std::vector<Pair>, std::greater<>> heap_;
  SquareFitter fitter_;
};

}  // namespace

MergeTree merge_by_moments(const LightCube& cube, const MergeOptions& options, const Context& context) {
  if (cube.count() == 0) return {};
  return {MomentMerger(cube, options).run(context), cube.count()};
}

}  // namespace sightline::square_lights
