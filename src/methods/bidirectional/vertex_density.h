// How densely the vertices of subpaths lie in the scene: what a visibility cache sizes its cells by.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/math/bounds.h"
#include "base/math/vec.h"

namespace sightline::bidirectional {

/// Marginal densities by counting vertices in the cells of a grid over the scene, 0.01 of its radius wide. Filled once, then read by all
/// threads.
class VertexDensity {
 public:
  VertexDensity(const Bounds& bounds, std::uint64_t samples_a_pass)
      : origin_(bounds.lower), cell_(0.01f * std::max(bounds.half_diagonal(), 1e-20f)), samples_a_pass_(samples_a_pass) {}

  /// Cell of a vertex, for counting.
  std::uint64_t cell_of(const Vec3& p) const;
  /// Takes in cells of vertices of `paths` samples.
  void count(std::span<std::uint64_t> eye_cells, std::span<std::uint64_t> light_cells, std::uint64_t paths);

  /// Area of the surface that one eye vertex of a pass stands for: 1 / (N P).
  float eye_cell_area(const Vec3& p) const;
  /// Area of the surface that one light vertex of a sample stands for: 1 / P.
  float light_cell_area(const Vec3& p) const;

 private:
  struct Entry {
    std::uint64_t cell;
    std::uint32_t eye, light;
  };
  const Entry* find(const Vec3& p) const;

  Vec3 origin_;
  float cell_;
  std::uint64_t samples_a_pass_, paths_ = 0;
  std::vector<Entry> table_;  ///< open addressing; an empty entry has no counts
};

}  // namespace sightline::bidirectional
