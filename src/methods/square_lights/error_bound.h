// How far the product of three means may be off, and which large lights to split because of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "methods/square_lights/merge_tree.h"
#include "methods/square_lights/moments.h"

namespace sightline::square_lights {

/// The luminance of a node's light: its own moments, over the region itself.
inline Moments light_moments(const MergeNode& node) {
  const float flux = node.light.solid_angle() * luminance(node.light.radiance);
  return {node.solid_angle > 0 ? flux / node.solid_angle : 0.f, node.deviation, node.third_moment};
}

/// What one receiver gets from a node, and how far that may be off; both in radiance.
struct NodeTerm {
  float value = 0, bound = 0;
};
/// For a node of which the visible part and the BRDF's moments (luminance of f cos; BrdfTable::moments) are known at the receiver.
inline NodeTerm node_term(const MergeNode& node, float visible, const Moments& brdf) {
  const Moments light = light_moments(node);
  return {node.solid_angle * light.mean * visible * brdf.mean,
          node.solid_angle * product_bound_binary(light, brdf, binary_moments(visible))};
}

/// Splits the nodes of a cut along the merge tree while their bound is above `part` of what the receiver gets in all, until nothing is left
/// to split or `most` nodes stand. Whole generations are asked for at once: `evaluate(std::span<const std::int32_t> nodes,
/// std::span<NodeTerm> terms)` fills `terms`. A receiver without light keeps its cut. The same for any number of threads: pure.
class CutRefiner {
 public:
  template <class Evaluate>
  std::span<const std::int32_t> refine(const MergeTree& tree, std::span<const std::int32_t> cut, float part, std::size_t most,
                                       Evaluate&& evaluate) {
    result_.clear();
    open_.assign(cut.begin(), cut.end());
    double total = 0;
    while (!open_.empty()) {
      terms_.assign(open_.size(), {});
      evaluate(std::span<const std::int32_t>(open_), std::span<NodeTerm>(terms_));
      for (const NodeTerm& term : terms_) total += term.value;
      split_open(tree, part * static_cast<float>(total), most, total);
    }
    return result_;
  }

 private:
  /// Nodes of this generation whose bound is above `limit` make way for their children, worst first; the others are done.
  void split_open(const MergeTree& tree, float limit, std::size_t most, double& total);

  std::vector<std::int32_t> result_, open_, next_;
  std::vector<NodeTerm> terms_;
  std::vector<std::uint32_t> order_;
};

}  // namespace sightline::square_lights
