// Visibility on the disk as signed distances to its boundary: one look-up says how much of a square is visible.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "base/math/vec.h"

namespace sightline::square_lights {

/// 32 x 32 values over [-1, 1]² of the disk, at cell centres, row by row (p.x along a row); int8 codes of distances in plane units, + where
/// visible.
inline constexpr int kTableSize = 32;
inline constexpr std::size_t kTableCells = std::size_t{kTableSize} * kTableSize;
using TableView = std::span<const std::int8_t, kTableCells>;

/// The code of a distance: steps of 1.5 / 127 = 0.012, a fifth of a cell; a table without any boundary holds the greatest.
inline constexpr float kDistanceStep = 1.5f / 127;
inline std::int8_t encode_distance(float d) { return static_cast<std::int8_t>(std::lround(std::clamp(d / kDistanceStep, -127.f, 127.f))); }
inline float decode_distance(float code) { return code * kDistanceStep; }

/// D at p: bilinear between cell centres, p clamped to the outermost of them. The scalar definition of what lanes do.
float distance_at(TableView table, const Vec2& p);
/// D and its gradient there (plane units per plane unit).
float distance_at(TableView table, const Vec2& p, Vec2& gradient);

/// How a distance becomes the visible fraction of a square of half diagonal r_p.
enum class Coverage {
  parallel,  ///< Eq. 9: exact for boundaries parallel to an edge of the square, at most 4.4 % off else
  average,   ///< mean over all turns of the boundary: at most 2.5 % off
  gradient,  ///< exact for straight boundaries, whose direction is that of the distance's gradient
};
/// Eq. 9. Deviation: the printed layout is garbled; this is ((r sqrt(2) / 2) + D) / (sqrt(2) r), which is exact for an edge parallel to the
/// square's.
inline float covered_parallel(float d, float r_p) {
  const float h = 0.70710678f * r_p;
  return std::clamp((h + d) / std::max(2 * h, 1e-12f), 0.f, 1.f);
}
float covered_average(float d, float r_p);
/// `normal` need not be unit; 0 falls back to the average.
float covered_gradient(float d, const Vec2& normal, float r_p);

/// Exact signed Euclidean distances in cells of an n x n map (1 visible, 0 not) to the boundary half way between samples: + inside the
/// visible part; +-infinity where there is no boundary [Felzenszwalb2012].
void signed_distances(std::span<const std::uint8_t> visible, int n, std::span<float> distances);

/// The table of a map traced at n x n (a multiple of 32) points of [-1, 1]², cell centres, `visible` 1 or 0. Points outside the unit disk
/// are given `kOutside` and take the value of the nearest one inside (the horizon is no occluder: the BRDF has it already), or count as
/// hidden with `count_horizon`, which darkens twice (an ablation). Distances are found at n x n and averaged.
inline constexpr std::uint8_t kOutside = 2;
void make_distance_table(std::span<const std::uint8_t> visible, int n, bool count_horizon, std::span<std::int8_t, kTableCells> table);

}  // namespace sightline::square_lights
