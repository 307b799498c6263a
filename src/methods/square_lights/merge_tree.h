// Merges the texels of a cube map into ever fewer regions, each with the square light that fits it: all numbers of lights from one run.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "methods/square_lights/light_cube.h"
#include "methods/square_lights/square_light.h"

namespace sightline::square_lights {

struct MergeOptions {
  /// Which pair is merged next: that with the least J of the merged region (the paper), or with the least growth J(ij) - J(i) - J(j), or
  /// with the least growth of flux² times variance of direction, with lights that have their region's first two moments (moment_merge.h).
  enum class Criterion { paper, ward, moments } criterion = Criterion::paper;
  bool area_penalty = true;  ///< the factor |S| of J; off is an ablation
};

/// A region that existed at some time: a texel, or the union of two earlier regions.
struct MergeNode {
  SquareLight light;
  float solid_angle = 0;               ///< |S| of the region itself
  float error = 0;                     ///< J, summed over channels
  float deviation = 0;                 ///< sigma_L: root mean square deviation of luminance from its mean within the region
  float third_moment = 0;              ///< m_L: third root of the mean cubed absolute deviation of luminance (Eq. 13)
  std::int32_t left = -1, right = -1;  ///< of a texel -1
};

/// All states of the decomposition. Nodes 0 ... texels - 1 are the texels; node texels + k came of merge k. Trivially stored: an array of
/// nodes says all.
class MergeTree {
 public:
  MergeTree() = default;
  MergeTree(std::vector<MergeNode> nodes, std::size_t texels) : nodes_(std::move(nodes)), texels_(texels) {}
  /// The heap version of Fig. 5. Regions never cross the edge of a face (but by moments); black maps merge all the same.
  static MergeTree build(const LightCube& cube, const MergeOptions& options, const Context& context);

  std::span<const MergeNode> nodes() const { return nodes_; }
  std::size_t texels() const { return texels_; }
  /// Fewest regions that merging reaches: one a face, by moments one.
  std::size_t least() const { return 2 * texels_ - nodes_.size(); }
  /// Nodes alive when `count` regions were left (clamped to what there is).
  std::vector<std::int32_t> cut(std::size_t count) const;
  std::vector<SquareLight> lights(std::size_t count) const;

 private:
  std::vector<MergeNode> nodes_;
  std::size_t texels_ = 0;
};

}  // namespace sightline::square_lights
