#include "methods/square_lights/disk_rays.h"

#include <algorithm>
#include <limits>

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
  DiskRays rays;
  for (std::size_t i = 0; i < grid.count(); ++i) {
    if (wanted(zoom * grid.point(i))) rays.point.push_back(static_cast<std::uint32_t>(i));
  }
  const auto n = static_cast<std::uint32_t>(grid.size());
  std::sort(rays.point.begin(), rays.point.end(),
            [n](std::uint32_t a, std::uint32_t b) { return morton(a % n, a / n) < morton(b % n, b / n); });
  rays.direction.resize(rays.count());
  for (std::size_t k = 0; k < rays.count(); ++k) {
    const Vec3 d = direction_from_disk(zoom * grid.point(rays.point[k]));
    rays.direction.x[k] = d.x, rays.direction.y[k] = d.y, rays.direction.z[k] = d.z;
  }
  return rays;
}

std::span<std::uint8_t> MapTracer::trace(const DiskRays& rays, const Frame3& frame, const Vec3& origin, const Vec3* side,
                                         std::uint8_t rest) {
  if (batch_.t_near.size() < padded(rays.count())) {
    batch_.resize(rays.count());
    occluded_.resize(padded(rays.count()));
    std::fill(batch_.t_near.begin(), batch_.t_near.end(), 0.f);
    std::fill(batch_.t_far.begin(), batch_.t_far.end(), std::numeric_limits<float>::infinity());
  }
  std::fill(map_.begin(), map_.end(), rest);
  // Only rays that are traced are kept, so that packets stay full.
  point_.resize(rays.count());
  const Vec3 local_side = side ? frame.to_local(*side) : Vec3(0);
  std::size_t count = 0;
  for (std::size_t k = 0; k < rays.count(); ++k) {
    const Vec3 local(rays.direction.x[k], rays.direction.y[k], rays.direction.z[k]);
    const Vec3 d = frame.to_world(local);
    batch_.direction.x[count] = d.x, batch_.direction.y[count] = d.y, batch_.direction.z[count] = d.z;
    point_[count] = rays.point[k];
    count += side == nullptr || glm::dot(local, local_side) > 0;
  }
  std::fill_n(batch_.origin.x.begin(), padded(count), origin.x);
  std::fill_n(batch_.origin.y.begin(), padded(count), origin.y);
  std::fill_n(batch_.origin.z.begin(), padded(count), origin.z);
  batch_.size = count;
  tracer_.occluded(batch_, occluded_, BatchKind::shadow, counts_);
  for (std::size_t k = 0; k < count; ++k) map_[point_[k]] = occluded_[k] ^ 1;
  return map_;
}

}  // namespace sightline::square_lights
