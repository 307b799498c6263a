// A BRDF times cosine as summed-area tables over the disk of light directions, one a view.
#pragma once

#include <cstddef>
#include <vector>

#include "base/core/aligned.h"
#include "base/core/context.h"
#include "base/math/vec.h"
#include "methods/square_lights/moments.h"
#include "shade/bsdf.h"

namespace sightline::square_lights {

class SharpLobe;  // sharp_lobe.h

/// 32 x 32 cells over [-1, 1]² of the disk; a table holds 33 x 33 corners, each the integral over all cells left of and above it, as four
/// floats (red, green, blue, square of the luminance), so that two neighbours along a row are one load.
class BrdfTable {
 public:
  static constexpr int kCells = 32, kCorners = 33, kViews = 32;
  /// Half edge of the smallest square that is looked up, half a cell: smaller ones would step from cell to cell, and drown in the rounding
  /// of sums. This one reads cells bilinearly.
  static constexpr float kLeastHalf = 1.f / kCells;
  static constexpr std::size_t kSliceFloats = std::size_t{kCorners} * kCorners * 4;

  /// Tables of `bsdf`: by view angle alone (32 of them over [0, pi/2]) where it looks the same turned about the normal, else for 32 x 32
  /// views of the disk. Cells are means, zero outside the disk: of 2 x 2 points where the function is smooth, of about `samples` x
  /// `samples` where it bends, of up to 8 times as many along an edge around peaks, which directions chosen by the BSDF itself find. Delta
  /// lobes are left out; light from below the surface too. Throws Error{interrupted} when cancelled.
  /// Without `lobe`, which is added by formula: tables are then of the difference and may be negative.
  static BrdfTable build(const Bsdf& bsdf, int samples, const Context& context, const SharpLobe* lobe = nullptr);

  bool isotropic() const { return isotropic_; }
  std::size_t bytes() const { return corners_.size() * sizeof(float); }

  /// Up to four tables and their weights for a view direction (local, unit, z > 0): two by angle, or four of the disk. `turn` is what p has
  /// to be turned by before it is looked up: (cos, sin) of minus the view's azimuth on the disk (its p comes to lie on +x), (1, 0) for
  /// anisotropic tables.
  struct Slices {
    const float* table[4] = {};
    float weight[4] = {};
    int count = 0;
    Vec2 turn{1, 0};
  };
  Slices slices(const Vec3& wo) const;
  /// Mean over the square of half diagonal `r_p` around `p` (not yet turned), of f cos as radiance per radiance and steradian: the integral
  /// over the square, which may leave the disk, by 2 r_p²; of squares below kLeastHalf that of the least one. The scalar definition of what
  /// the lanes do.
  Color mean(const Slices& slices, const Vec2& p, float r_p) const;
  /// Mean and deviation of the luminance of f cos over the same square (between cells; third moments are not known and stay 0), for error
  /// bounds. Of two or four slices the deviation is the greatest that fits them.
  Moments moments(const Slices& slices, const Vec2& p, float r_p) const;

 private:
  static Vec4 mean_of_four(const Slices& slices, const Vec2& p, float r_p);

  bool isotropic_ = true, signed_ = false;
  AlignedVector<float> corners_;  ///< [view][row][column][4]; rows follow p.y, columns p.x
};

/// Whether a BSDF looks the same however it is turned about the normal.
bool is_isotropic(const Bsdf& bsdf);

}  // namespace sightline::square_lights
