#include "methods/square_lights/disk_rays.h"

#include <algorithm>
#include <limits>

#include "base/math/vec3_batch.h"
#include "methods/square_lights/hemisphere_disk.h"

namespace sightline::square_lights {
namespace {

/// Bits of x and y in turn.
std::uint32_t morton(std::uint32_t x, std::uint32_t y) {
  std::uint32_t code = 0;
  for (std::uint32_t bit = 0; bit < 16; ++bit) code |= (x >> bit & 1u) << (2 * bit) | (y >> bit & 1u) << (2 * bit + 1);
  return code;
}

}  // namespace

DiskRays make_disk_rays(const DiskGrid& grid, float zoom, const std::function<bool(const Vec2&)>& wanted) {
  std::vector<std::uint32_t> order;
  for (std::size_t i = 0; i < grid.count(); ++i) {
    if (wanted(zoom * grid.point(i))) order.push_back(static_cast<std::uint32_t>(i));
  }
  const auto n = static_cast<std::uint32_t>(grid.size());
  std::sort(order.begin(), order.end(), [n](std::uint32_t a, std::uint32_t b) { return morton(a % n, a / n) < morton(b % n, b / n); });

  DiskRays rays;
  rays.size = order.size();
  rays.direction.resize(rays.size);
  rays.point.resize(padded(rays.size));
  for (std::size_t k = 0; k < rays.size; ++k) {
    rays.point[k] = order[k];
    store(rays.direction, k, direction_from_disk(zoom * grid.point(order[k])));
  }
  return rays;
}

MapTracer::MapTracer(const Tracer& tracer, std::size_t points) : tracer_(tracer), map_(points) {
  const std::size_t room = padded(points) + kLanes;
  batch_.resize(room);
  std::fill(batch_.t_far.begin(), batch_.t_far.end(), std::numeric_limits<float>::infinity());
  point_.resize(room);
  occluded_.resize(room);
}

std::span<std::uint8_t> MapTracer::trace(const DiskRays& rays, const Frame3& frame, const Vec3& origin, const Vec3* side,
                                         std::uint8_t rest) {
  // Only rays that are traced are kept, so that packets stay full.
  const std::size_t count = turn_rays(rays, frame, side, batch_.direction, point_.data());
  batch_.size = count;
  fill(batch_.origin, 0, padded(count), origin);
  tracer_.occluded(batch_, occluded_, BatchKind::shadow, counts_);
  std::fill(map_.begin(), map_.end(), rest);
  for (const std::uint32_t point : rays.hidden) map_[point] = 0;
  for (std::size_t k = 0; k < count; ++k) map_[point_[k]] = occluded_[k] ^ 1;
  return map_;
}

}  // namespace sightline::square_lights
