// How densely the vertices of subpaths lie in the scene: what a visibility cache sizes its cells by.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/math/bounds.h"
#include "base/math/vec.h"
#include "methods/bidirectional/vertex.h"

namespace sightline::bidirectional {

/// What one sample of a pass stands for at a vertex, for the ends of queries. Marginal: by counting vertices in the cells of a grid over
/// the scene, 0.01 of its radius wide. Conditional: by the density of the vertex given the one before, which is higher, so that cells are
/// finer. Filled once, then read by all threads.
class VertexDensity {
 public:
  enum class Kind { marginal, conditional };
  VertexDensity(Kind kind, const Bounds& bounds, std::uint64_t samples_a_pass);

  Kind kind() const { return kind_; }
  /// Cell of a vertex, for counting.
  std::uint64_t cell_of(const Vec3& p) const;
  /// Takes in the cells of the vertices of `paths` samples, in any order.
  void count(std::span<const std::uint64_t> eye_cells, std::span<const std::uint64_t> light_cells, std::uint64_t paths);

  /// Area of the surface that one eye vertex of a pass stands for: 1 / (N P). 0 where it is not known.
  float eye_cell_area(const PathVertex& vertex) const;
  /// Area of the surface that one light vertex of a sample stands for: 1 / P.
  float light_cell_area(const PathVertex& vertex) const;

 private:
  struct Entry {
    std::uint64_t cell;
    std::uint32_t eye, light;
  };
  const Entry* find(const Vec3& p) const;
  static float conditional_area(const PathVertex& vertex);

  Kind kind_;
  Vec3 origin_;
  float cell_;
  std::uint64_t samples_a_pass_, paths_ = 0;
  std::vector<Entry> table_;  ///< open addressing; an empty entry has no counts
};

}  // namespace sightline::bidirectional
