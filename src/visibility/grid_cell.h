// Cells of regular grids.
#pragma once

#include <cstdint>

namespace sightline {

/// The cell of `position` in [0, count): below the grid the first, above it the last, and some cell for what is not a number.
inline std::uint32_t grid_cell(float position, std::uint32_t count) {
  const float last = static_cast<float>(count - 1);
  const float not_below = position > 0 ? position : 0;
  return static_cast<std::uint32_t>(not_below < last ? not_below : last);
}

}  // namespace sightline
