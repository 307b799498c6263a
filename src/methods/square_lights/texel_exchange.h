// Regions of one cut of the merge tree made better: merging never takes back what it did, but texels can change sides.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "methods/square_lights/merge_tree.h"

namespace sightline::square_lights {

struct TexelExchange {
  std::vector<SquareLight> lights;    ///< as MergeOptions::Criterion::moments has them: centroid and second moment of luminance
  std::vector<std::uint32_t> region;  ///< of each texel
  double before = 0, after = 0;       ///< sum over regions and channels of flux² times mean squared distance from the centre
  int sweeps = 0;
  std::uint64_t bytes() const { return lights.size() * sizeof(SquareLight) + region.size() * sizeof(std::uint32_t); }
};

/// Starts from the regions that are left when `count` are. Texels at borders then move, one after the other, to that neighbour (on any
/// face) where they add least to the error, until a sweep over all of them lessens it no more [Lloyd1982]. No region loses its last texel.
TexelExchange exchange_texels(const LightCube& cube, const MergeTree& tree, std::size_t count);

}  // namespace sightline::square_lights
