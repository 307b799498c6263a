// Visibility on the disk as signed distances to its boundary: one look-up says how much of a square is visible.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

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

/// D at p: bilinear between cell centres, p clamped to the outermost of them. The scalar definition of what lanes do, which may read up to
/// kTableSlack bytes past the end of a table.
inline constexpr std::size_t kTableSlack = 64;
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
/// What covered_average() interpolates: element i is the mean coverage at d / r_p = i / 16, of non-negative distances. The other half is 1
/// minus that.
inline constexpr std::size_t kAverageCoverages = 17;
const std::array<float, kAverageCoverages>& average_coverages();
/// `normal` need not be unit; 0 falls back to the average.
float covered_gradient(float d, const Vec2& normal, float r_p);

/// Exact signed Euclidean distances in cells of an n x n map (1 visible, 0 not) to the boundary half way between samples: + inside the
/// visible part; +-infinity where there is no boundary [Felzenszwalb2012].
void signed_distances(std::span<const std::uint8_t> visible, int n, std::span<float> distances);

/// What all maps of n x n points of [-1, 1]² (cell centres, n a multiple of 32) have in common: immutable, to be made once and shared.
class DiskGrid {
 public:
  explicit DiskGrid(int n);
  int size() const { return n_; }
  std::size_t count() const { return inside_.size(); }
  /// p of point i = y * n + x.
  Vec2 point(std::size_t i) const;
  bool inside(std::size_t i) const { return inside_[i] == i; }
  /// The point of the unit disk nearest to point i: i itself inside.
  std::span<const std::uint32_t> nearest_inside() const { return inside_; }

 private:
  int n_;
  std::vector<std::uint32_t> inside_;
};

/// The table of a map, 1 where visible and 0 where not. Distances are found at n x n points and averaged. The whole square counts.
void make_distance_table(std::span<const std::uint8_t> visible, int n, std::span<std::int8_t, kTableCells> table);
/// What a map of a hemisphere holds beyond the unit disk, which is not known: the value of the nearest point inside (the horizon is no
/// occluder: the BRDF has it already), or, with `count_horizon`, hidden, which darkens twice (an ablation).
void fill_outside(const DiskGrid& grid, bool count_horizon, std::span<std::uint8_t> visible);

}  // namespace sightline::square_lights
