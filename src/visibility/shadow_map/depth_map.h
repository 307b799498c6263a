// Distances from one light to the first surface, a texel a direction or parallel ray.
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/math/bounds.h"
#include "base/math/vec.h"
#include "trace/tracer.h"
#include "visibility/grid_cell.h"
#include "visibility/zero_pages.h"

namespace sightline {

/// A cube map around a point, or one orthographic map along a direction. Texels are filled tile by tile, at any time and from any thread:
/// what a texel holds depends on nothing but the scene, so who fills it does not matter. Memory is touched where tiles are filled.
class DepthMap {
 public:
  static constexpr std::uint32_t kTileSize = 32, kTileTexels = kTileSize * kTileSize;

  static DepthMap around(const Vec3& position, std::uint32_t resolution);
  /// `travel` is the unit direction in which light travels; the map covers `bounds`.
  static DepthMap along(const Vec3& travel, const Bounds& bounds, std::uint32_t resolution);

  /// Where a point falls into the map, how far it is from the light, and how much that changes over a texel's width on the plane through
  /// the point with `normal` (0 if that is the zero vector: a point in space).
  struct Place {
    std::size_t texel;
    float distance, change;
  };
  Place locate(const Vec3& point, const Vec3& normal) const;
  /// Distance of the first surface at the texel's centre, infinity if there is none; 0 if the texel is not filled yet.
  float depth(std::size_t texel) const { return std::atomic_ref(texels_[texel]).load(std::memory_order_relaxed); }
  void prefetch(std::size_t texel) const { __builtin_prefetch(&texels_[texel]); }

  /// Null for parallel maps: where a cube map is centred.
  const Vec3* center() const { return cube_ ? &origin_ : nullptr; }
  std::uint32_t resolution() const { return resolution_; }
  std::uint32_t tiles_across() const { return tiles_across_; }

  static std::size_t tile_of(std::size_t texel) { return texel / kTileTexels; }
  std::size_t tile_count() const { return tile_count_; }
  std::uint64_t bytes_when_full() const { return tile_count_ * kTileTexels * sizeof(float); }

  /// Scratch of one thread.
  struct Filler {
    RayBatch rays;
    HitBatch hits;
  };
  /// Fills a tile; false if another call has begun to do so before. Either way the tile is filled on return.
  bool fill(std::size_t tile, const Tracer& tracer, Filler& filler, RayCounts& counts) const;

 private:
  DepthMap(std::uint32_t resolution, std::uint32_t faces);
  std::size_t index(std::uint32_t face, std::uint32_t x, std::uint32_t y) const;
  Ray ray_of(std::uint32_t face, std::uint32_t x, std::uint32_t y) const;
  /// Texel at image position `u` in [-1, 1].
  std::uint32_t coordinate(float u) const { return grid_cell((0.5f * u + 0.5f) * static_cast<float>(resolution_), resolution_); }

  bool cube_ = true;
  std::uint32_t resolution_, tiles_across_;
  float texel_size_;  ///< 1 / resolution
  std::size_t tile_count_;
  Vec3 origin_{0};                                                 ///< the light; of parallel maps the centre of the plane where rays start
  Vec3 u_{1, 0, 0}, v_{0, 1, 0}, w_{0, 0, 1};                      ///< axes of a parallel map: w is the direction of travel
  float half_ = 1;                                                 ///< half its edge
  ZeroPages<float> texels_;                                        ///< a tile is a page
  std::unique_ptr<std::vector<std::atomic<std::uint8_t>>> begun_;  ///< a tile each
};

inline std::size_t DepthMap::index(std::uint32_t face, std::uint32_t x, std::uint32_t y) const {
  // Tiles, in them blocks of 4x4: a packet of rays, and a cache line of look-ups.
  const std::size_t tile = (static_cast<std::size_t>(face) * tiles_across_ + y / kTileSize) * tiles_across_ + x / kTileSize;
  const std::uint32_t within = ((y >> 2 & 7) << 7) | ((x >> 2 & 7) << 4) | ((y & 3) << 2) | (x & 3);
  return tile * kTileTexels + within;
}

inline DepthMap::Place DepthMap::locate(const Vec3& point, const Vec3& normal) const {
  // Grazing light: the tangent is let grow to 10^4.
  const auto tangent = [&normal](float length_squared_of_d, float height) {
    if (normal == Vec3(0)) return 0.f;
    const float across = std::sqrt(std::fmax(length_squared_of_d - height * height, 0.f));
    return across > 0 ? across / std::fmax(height, 1e-4f * across) : 0.f;
  };
  const Vec3 d = point - origin_;
  if (!cube_) {
    const std::uint32_t x = coordinate(glm::dot(d, u_) / half_), y = coordinate(glm::dot(d, v_) / half_);
    return {index(0, x, y), glm::dot(d, w_), 2 * half_ * texel_size_ * tangent(1, std::fabs(glm::dot(normal, w_)))};
  }
  // The face is the axis of the largest component; the other two, in cyclic order, are its coordinates.
  const Vec3 size = glm::abs(d);
  const bool x = size.x >= size.y && size.x >= size.z, y = !x && size.y >= size.z;
  const float along = x ? d.x : y ? d.y : d.z, b = x ? d.y : y ? d.z : d.x, c = x ? d.z : y ? d.x : d.y;
  const float major = std::fabs(along), inverse = major > 0 ? 1 / major : 0.f, squared = length_squared(d);
  const std::uint32_t face = (x ? 0u : y ? 2u : 4u) + (along < 0 ? 1u : 0u);
  return {index(face, coordinate(b * inverse), coordinate(c * inverse)), std::sqrt(squared),
          2 * major * texel_size_ * tangent(squared, std::fabs(glm::dot(normal, d)))};
}

}  // namespace sightline
