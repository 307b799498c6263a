// From a vertex to the cell of a multi-resolution grid [Popov2013, §3.3-3.5]: the scalar definitions.
#pragma once

#include <cstdint>

#include "base/core/aligned.h"
#include "base/math/bounds.h"
#include "base/math/vec.h"
#include "visibility/cached/key.h"
#include "visibility/cached/settings.h"

namespace sightline {

/// A surface vertex in the grid of its quantised orientation: coordinates in [0, 1) across the scene, resolution not yet applied.
struct GridPoint {
  float x = 0, y = 0, z = 0;
  std::uint32_t bins = 0;  ///< quantised normal, as in EndWords::packed
  float log_area = 0;      ///< log2 of the cell area of one sample; infinity: not known
};

/// What the quantisation of a scene needs to know, for the scalar definitions and the vector kernels alike.
struct GridConstants {
  Vec3 center{0};       ///< C_s
  float scale = 0;      ///< 1 / (2 B_R)
  float bins = 8;       ///< C_N
  float bin_shift = 0;  ///< 1/2 where normals are rounded, 0 where they are floored
  float flatness = 8;   ///< C_Z
  std::uint32_t stride = 9;
  const float* frames = nullptr;      ///< nine floats (x, y, z axis) for each orientation, index qx + stride (qy + stride qz)
  const float* resolution = nullptr;  ///< R of each level: max(1, floor(C_R^k)) [Popov2013, Eq. 8]
  float last_level = 0;               ///< finest level whose cells floats can tell apart
  float first_sphere_level = 0;       ///< coarsest level of spheres: a cell is never the whole sphere
  float levels_per_octave = 0;        ///< 1 / log2 C_R
  float light_offset = 0;             ///< level of R = 2 B_R
  float sphere_offset = 0;            ///< level of R(w) for cells of one steradian
  bool equal_area = true;
  bool known = false;  ///< false: the scene is empty, nothing is cached
};

/// log2 of a positive normal float, to 5e-6; the same bits in scalar and vector code.
float fast_log2(float x);

class Quantizer {
 public:
  Quantizer(const Bounds& scene, const CachedVisibilitySettings& settings);
  Quantizer(const Quantizer&) = delete;
  Quantizer& operator=(const Quantizer&) = delete;

  const GridConstants& constants() const { return constants_; }
  /// Level (not yet rounded) of an eye cell of one sample of area 1: R = 2 B_R / (C_E sqrt(area)) [Popov2013, Eq. 7].
  float eye_offset(float ce) const;
  /// The same for both ends of [Popov2013, Eq. 6]: R = 2 B_R / (sqrt(C_E) (a_x a_y)^(1/4)).
  float symmetric_offset(float ce) const;

  GridPoint locate(const Vec3& position, const Vec3& normal, float cell_area) const;
  /// Cell of a surface vertex at `level` (rounded here).
  EndWords cell(const GridPoint& point, float level) const;
  EndWords eye(const GridPoint& point, float offset) const;
  /// A light end by itself [Popov2013, §3.5]; `shift` levels finer than its own.
  EndWords light(QuerySemantic semantic, const Vec3& position, const Vec3& normal, float cell_area, float shift = 0) const;
  /// Both ends of a connection, on the same level where both are surfaces.
  struct Pair {
    EndWords eye, light;
  };
  Pair connection(const GridPoint& eye, QuerySemantic semantic, const Vec3& position, const Vec3& normal, float cell_area, float ce) const;

  /// Axes of the grid for a quantised normal.
  Mat3 frame(std::uint32_t bins) const;
  float resolution(std::uint32_t level) const { return resolution_[level]; }

 private:
  AlignedVector<float> frames_, resolution_;
  GridConstants constants_;
};

/// Direction to the unit square: [Clarberg2008] without distortion of area, or [Engelhardt2008].
Vec2 sphere_to_square(const Vec3& direction, bool equal_area);

}  // namespace sightline
