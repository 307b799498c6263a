// Where geometry changes, as maxima over ever larger squares: decides which fragments cannot be one.
#pragma once

#include <array>
#include <vector>

#include "base/core/aligned.h"
#include "methods/fragments/fragment.h"
#include "methods/fragments/g_buffer.h"

namespace sightline {

struct GeometryOptions {
  float tau_n = 0.35f;         ///< greatest change of the normal within a fragment
  float tau_d = 0.01f;         ///< greatest relative change of depth
  bool plane_distance = true;  ///< change of depth as the distance from the tangent plane: not felt by slanted surfaces
  int coarsest = kRootLevel;
};

/// Maxima of one root tile.
class DiscontinuityPyramid {
 public:
  DiscontinuityPyramid();
  /// `flat`, unless it is null, is filled as GBuffer::flat.
  void build(const GBuffer& g, const RootTile& tile, const GeometryOptions& options, std::uint8_t* flat = nullptr);
  /// Fragments that cover the tile and hold no discontinuity, coarse ones first where they may be; those of level 0 too. Squares without
  /// any surface to interpolate on are left out.
  void refine(const GBuffer& g, const RootTile& tile, const GeometryOptions& options, std::vector<Fragment>& fragments) const;

  /// Level m, texel (x, y) of the tile's 2^(7-m) squared ones.
  float curvature(int m, int x, int y) const { return kappa_[index(m)][at(m, x, y)]; }
  float depth_change(int m, int x, int y) const { return dz_[index(m)][at(m, x, y)]; }

 private:
  static std::size_t index(int m) { return static_cast<std::size_t>(m); }
  static std::size_t at(int m, int x, int y) { return static_cast<std::size_t>(y << (kRootLevel - m)) + static_cast<std::size_t>(x); }
  void refine(const GBuffer& g, const RootTile& tile, const GeometryOptions& options, int m, int x, int y,
              std::vector<Fragment>& fragments) const;
  std::array<AlignedVector<float>, kRootLevel + 1> kappa_, dz_;
  std::array<AlignedVector<std::uint8_t>, kRootLevel + 1> any_;  ///< 1: holds something to interpolate
};

}  // namespace sightline
