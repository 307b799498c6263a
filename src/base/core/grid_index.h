// Places in arrays that hold rows one after the other.
#pragma once

#include <cstddef>

namespace sightline {

/// Of column `x` in row `y`, neither negative, with `width` columns a row.
inline std::size_t grid_index(int x, int y, int width) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
}

}  // namespace sightline
