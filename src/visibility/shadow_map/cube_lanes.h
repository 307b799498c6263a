// Places of many points in cube maps, side by side.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "base/core/aligned.h"

namespace sightline {

/// What DepthMap::locate says of points in cube maps of one resolution, for a block of queries whose maps may all differ. The caller fills
/// in offsets and normals of `count` lanes; the others may hold anything.
struct CubeLanes {
  static constexpr std::size_t kSize = 64;
  template <class T>
  using Lanes = std::array<T, kSize>;

  alignas(kCacheLine) Lanes<float> x, y, z;     ///< of the point, from the light
  alignas(kCacheLine) Lanes<float> nx, ny, nz;  ///< its normal, or 0
  alignas(kCacheLine) Lanes<std::uint32_t> texel;
  alignas(kCacheLine) Lanes<float> distance, change;

  void locate(std::uint32_t resolution, std::uint32_t tiles_across);
};

}  // namespace sightline
