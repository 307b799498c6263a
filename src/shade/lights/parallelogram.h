// Two triangles that make a parallelogram: how most files write a rectangular lamp.
#pragma once

#include <array>
#include <limits>
#include <optional>

#include "base/math/vec.h"

namespace sightline {

using TriangleCorners = std::array<Vec3, 3>;

/// `first` turned so that its first corner lies opposite to the edge shared with `second`, if the two run through that edge in opposite
/// senses and make a parallelogram to within rounding; then corner 0 plus the two edges from it span both.
inline std::optional<TriangleCorners> parallelogram_of(const TriangleCorners& first, const TriangleCorners& second) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 &a = first[i], &b = first[(i + 1) % 3], &c = first[(i + 2) % 3];
    for (std::size_t j = 0; j < 3; ++j) {
      if (second[j] != c || second[(j + 1) % 3] != b) continue;
      const Vec3& d = second[(j + 2) % 3];
      const Vec3 gap = glm::abs((d - b) - (c - a));
      // Rounding of the corners, and a little for files with few digits: far less than what one sees of a lamp's edge.
      const float size = max_component(glm::max(glm::abs(b - a), glm::abs(c - a)));
      const float coarse = max_component(glm::max(glm::abs(d), glm::max(glm::abs(b), glm::abs(c))));
      if (max_component(gap) <= 1e-6f * size + 4 * std::numeric_limits<float>::epsilon() * coarse) return TriangleCorners{a, b, c};
    }
  }
  return std::nullopt;
}

}  // namespace sightline
