#include "methods/square_lights/merge_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <queue>
#include <tuple>
#include <utility>

#include "base/parallel/parallel.h"
#include "methods/square_lights/moment_merge.h"
#include "methods/square_lights/region_moments.h"
#include "methods/square_lights/square_fit.h"

namespace sightline::square_lights {
namespace {

/// Regions of fewer texels are fitted from four points of each.
constexpr std::size_t kFineTexels = 64;

/// A texel of a face: itself, and its quarters.
struct TexelPoints {
  Vec3 center;
  float solid_angle;
  std::array<Vec3, 4> quarter;
  std::array<float, 4> quarter_angle;
};

std::vector<TexelPoints> texel_points(int face, int size) {
  std::vector<TexelPoints> result;
  result.reserve(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      TexelPoints& t = result.emplace_back();
      t.center = glm::normalize(cube_direction(face, cube_coordinate(x, size), cube_coordinate(y, size)));
      t.solid_angle = cube_texel_solid_angle(x, y, size);
      for (int q = 0; q < 4; ++q) {
        const int i = 2 * x + q % 2, j = 2 * y + q / 2;
        const auto k = static_cast<std::size_t>(q);
        t.quarter[k] = glm::normalize(cube_direction(face, cube_coordinate(i, 2 * size), cube_coordinate(j, 2 * size)));
        t.quarter_angle[k] = cube_texel_solid_angle(i, j, 2 * size);
      }
    }
  }
  return result;
}

/// Merges the texels of one face down to one region. Nodes are numbered within the face, texels first.
class FaceMerger {
 public:
  FaceMerger(const LightCube& cube, int face, const MergeOptions& options)
      : options_(options),
        size_(static_cast<std::size_t>(cube.size)),
        texels_(size_ * size_),
        points_(texel_points(face, cube.size)),
        radiance_(cube.texels.data() + static_cast<std::size_t>(face) * texels_) {}

  void run(const Context& context) {
    nodes_.reserve(2 * texels_ - 1);
    regions_.resize(2 * texels_ - 1);
    for (std::size_t i = 0; i < texels_; ++i) add_texel(i);
    for (std::size_t i = 0; i < texels_; ++i) {
      if (i % size_ + 1 < size_) link(i, i + 1);
      if (i + size_ < texels_) link(i, i + size_);
    }
    while (!heap_.empty()) {
      const Pair pair = heap_.top();
      heap_.pop();
      if (regions_[pair.a].alive && regions_[pair.b].alive) {
        merge(pair);
        if (nodes_.size() % 64 == 0) context.check_cancelled();
      }
    }
  }

  const std::vector<MergeNode>& nodes() const { return nodes_; }
  /// Key of merge k, by which faces take turns.
  float key(std::size_t k) const { return keys_[k]; }
  std::size_t merges() const { return keys_.size(); }

 private:
  struct Region {
    std::vector<std::uint32_t> texels, neighbours;
    bool alive = false;
  };
  struct Pair {
    float key;
    std::uint32_t a, b;  // a < b
    SquareFit fit;
    bool operator>(const Pair& other) const { return std::tie(key, a, b) > std::tie(other.key, other.a, other.b); }
  };

  void collect(const std::vector<std::uint32_t>& texels, bool fine) {
    for (const std::uint32_t t : texels) {
      const TexelPoints& p = points_[t];
      if (!fine) {
        fitter_.add(p.center, p.solid_angle, radiance_[t]);
        continue;
      }
      for (std::size_t q = 0; q < 4; ++q) fitter_.add(p.quarter[q], p.quarter_angle[q], radiance_[t]);
    }
  }

  void add_texel(std::size_t i) {
    const auto texel = static_cast<std::uint32_t>(i);
    regions_[i].texels = {texel};
    regions_[i].alive = true;
    fitter_.clear();
    collect(regions_[i].texels, true);
    MergeNode node;
    const float radius = std::sqrt(points_[i].solid_angle / 2);
    node.light = {points_[i].center, radius, radiance_[i]};
    node.solid_angle = points_[i].solid_angle;
    node.error = static_cast<float>(std::max(0.0, fitter_.error(points_[i].center, radius, options_.area_penalty)));
    nodes_.push_back(node);
  }

  void link(std::size_t a, std::size_t b) {
    regions_[a].neighbours.push_back(static_cast<std::uint32_t>(b));
    regions_[b].neighbours.push_back(static_cast<std::uint32_t>(a));
    push(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b));
  }

  void push(std::uint32_t a, std::uint32_t b) {
    const std::size_t texels = regions_[a].texels.size() + regions_[b].texels.size();
    fitter_.clear();
    collect(regions_[a].texels, texels < kFineTexels);
    collect(regions_[b].texels, texels < kFineTexels);
    const std::array<Vec3, 2> starts{nodes_[a].light.center, nodes_[b].light.center};
    const SquareFit fit = fitter_.fit(starts, options_.area_penalty);
    float key = fit.error;
    if (options_.criterion == MergeOptions::Criterion::ward) key -= nodes_[a].error + nodes_[b].error;
    heap_.push({key, a, b, fit});
  }

  void merge(const Pair& pair) {
    const auto id = static_cast<std::uint32_t>(nodes_.size());
    Region &a = regions_[pair.a], &b = regions_[pair.b], &merged = regions_[id];
    // In order, so that sums over a region do not depend on how it came about.
    std::merge(a.texels.begin(), a.texels.end(), b.texels.begin(), b.texels.end(), std::back_inserter(merged.texels));
    std::sort(a.neighbours.begin(), a.neighbours.end());
    std::sort(b.neighbours.begin(), b.neighbours.end());
    std::set_union(a.neighbours.begin(), a.neighbours.end(), b.neighbours.begin(), b.neighbours.end(),
                   std::back_inserter(merged.neighbours));
    std::erase_if(merged.neighbours, [&](std::uint32_t n) { return n == pair.a || n == pair.b; });
    a = {}, b = {};
    merged.alive = true;

    MergeNode node;
    node.light = pair.fit.light;
    node.solid_angle = pair.fit.solid_angle;
    node.error = pair.fit.error;
    node.left = static_cast<std::int32_t>(pair.a);
    node.right = static_cast<std::int32_t>(pair.b);
    set_moments(
        node, merged.texels, [this](std::uint32_t t) { return points_[t].solid_angle; }, [this](std::uint32_t t) { return radiance_[t]; });
    nodes_.push_back(node);
    keys_.push_back(pair.key);

    for (const std::uint32_t n : merged.neighbours) {
      std::erase_if(regions_[n].neighbours, [&](std::uint32_t m) { return m == pair.a || m == pair.b; });
      regions_[n].neighbours.push_back(id);
      push(n, id);
    }
  }

  MergeOptions options_;
  std::size_t size_, texels_;
  std::vector<TexelPoints> points_;
  const Color* radiance_;
  std::vector<MergeNode> nodes_;
  std::vector<float> keys_;
  std::vector<Region> regions_;
  std::priority_queue<Pair, std::vector<Pair>, std::greater<>> heap_;
  SquareFitter fitter_;
};

}  // namespace

MergeTree MergeTree::build(const LightCube& cube, const MergeOptions& options, const Context& context) {
  if (options.criterion == MergeOptions::Criterion::moments) return merge_by_moments(cube, options, context);
  const std::size_t face_texels = cube.count() / kCubeFaces;
  std::vector<FaceMerger> faces;
  faces.reserve(kCubeFaces);
  for (int face = 0; face < kCubeFaces; ++face) faces.emplace_back(cube, face, options);
  parallel_for(context, kCubeFaces, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t face = begin; face < end; ++face) faces[face].run(context);
  });

  // What is merged within a face does not depend on the others, so that one heap for all would have done the merges of each face in the
  // same order, and always the one next whose key is least.
  std::vector<MergeNode> nodes;
  nodes.reserve(2 * cube.count() - kCubeFaces);
  for (const FaceMerger& face : faces) nodes.insert(nodes.end(), face.nodes().begin(), face.nodes().begin() + face_texels);
  std::array<std::vector<std::int32_t>, kCubeFaces> global;  // by merge of a face
  const auto global_id = [&](std::size_t face, std::int32_t local) {
    const auto i = static_cast<std::size_t>(local);
    return i < face_texels ? static_cast<std::int32_t>(face * face_texels + i) : global[face][i - face_texels];
  };
  while (true) {
    std::size_t next = kCubeFaces;
    for (std::size_t face = 0; face < kCubeFaces; ++face) {
      const std::size_t k = global[face].size();
      if (k == faces[face].merges()) continue;
      if (next == kCubeFaces || faces[face].key(k) < faces[next].key(global[next].size())) next = face;
    }
    if (next == kCubeFaces) break;
    MergeNode node = faces[next].nodes()[face_texels + global[next].size()];
    node.left = global_id(next, node.left);
    node.right = global_id(next, node.right);
    global[next].push_back(static_cast<std::int32_t>(nodes.size()));
    nodes.push_back(node);
  }
  return {std::move(nodes), cube.count()};
}

std::vector<std::int32_t> MergeTree::cut(std::size_t count) const {
  if (nodes_.empty()) return {};
  const std::size_t merges = texels_ - std::clamp(count, least(), texels_), end = texels_ + merges;
  std::vector<std::uint8_t> merged(end, 0);
  for (std::size_t i = texels_; i < end; ++i) {
    merged[static_cast<std::size_t>(nodes_[i].left)] = 1;
    merged[static_cast<std::size_t>(nodes_[i].right)] = 1;
  }
  std::vector<std::int32_t> result;
  result.reserve(texels_ - merges);
  for (std::size_t i = 0; i < end; ++i) {
    if (!merged[i]) result.push_back(static_cast<std::int32_t>(i));
  }
  return result;
}

std::vector<SquareLight> MergeTree::lights(std::size_t count) const {
  std::vector<SquareLight> result;
  for (const std::int32_t node : cut(count)) result.push_back(nodes_[static_cast<std::size_t>(node)].light);
  return result;
}

}  // namespace sightline::square_lights
