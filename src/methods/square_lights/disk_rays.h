// The directions of a map's points, in an order that keeps neighbours together, and the rays along them.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/core/aligned.h"
#include "base/math/frame.h"
#include "methods/square_lights/distance_table.h"
#include "trace/tracer.h"

namespace sightline::square_lights {

/// Local unit directions and the points of the map that they belong to, in small blocks of the disk (Morton order), so that packets of rays
/// are coherent. Immutable.
struct DiskRays {
  Vec3Batch direction;
  AlignedVector<std::uint32_t> point;  ///< padded to kLanes
  std::vector<std::uint32_t> hidden;   ///< points of a map that are hidden whatever is traced
  std::size_t size = 0;
  std::size_t count() const { return size; }
};
/// Directions of those points of the grid, spread to `zoom` times their place, that `wanted` takes (given p after zooming).
DiskRays make_disk_rays(const DiskGrid& grid, float zoom, const std::function<bool(const Vec2&)>& wanted);

/// The directions in world space, and their points, of those rays whose cosine with `side` (may be null: all) is positive; how many they
/// are. Both have room for padded(count) + kLanes elements.
std::size_t turn_rays(const DiskRays& rays, const Frame3& frame, const Vec3* side, Vec3Batch& direction, std::uint32_t* point);

/// Which points of a map see past a tracer's geometry: one worker's room for it.
class MapTracer {
 public:
  MapTracer(const Tracer& tracer, std::size_t points);
  /// Rays from `origin` along all directions of `rays` in `frame` whose cosine with `side` is positive; those of the others and of points
  /// without a ray get `rest`. The map: 1 visible, 0 not.
  std::span<std::uint8_t> trace(const DiskRays& rays, const Frame3& frame, const Vec3& origin, const Vec3* side, std::uint8_t rest);
  const RayCounts& counts() const { return counts_; }

 private:
  const Tracer& tracer_;
  std::vector<std::uint8_t> map_;
  AlignedVector<std::uint32_t> point_;
  RayBatch batch_;
  AlignedVector<std::uint8_t> occluded_;
  RayCounts counts_;
};

}  // namespace sightline::square_lights
