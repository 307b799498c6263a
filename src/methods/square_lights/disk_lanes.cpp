// Directions of a map turned into a frame, those on the wrong side left out.
#include "methods/square_lights/disk_rays.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "methods/square_lights/disk_lanes.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "base/simd/vec3-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

using namespace lanes;

std::size_t TurnRays(const square_lights::DiskRays& rays, const Frame3& frame, const Vec3* side, Vec3Batch& direction,
                     std::uint32_t* HWY_RESTRICT point) {
  const D d;
  const DU du;
  const V3 tangent = set3(d, frame.tangent), bitangent = set3(d, frame.bitangent), normal = set3(d, frame.normal);
  const V3 up = set3(d, side ? *side : Vec3(0));
  std::size_t count = 0;
  for (std::size_t k = 0; k < rays.count(); k += hn::Lanes(d)) {
    const V3 local = load3(d, rays.direction, k);
    const V3 turned = add3(add3(scale3(tangent, local.x), scale3(bitangent, local.y)), scale3(normal, local.z));
    M kept = hn::FirstN(d, rays.count() - k);
    if (side) kept = hn::And(kept, hn::Gt(dot3(turned, up), hn::Zero(d)));
    compress_store3(d, turned, kept, direction, count);
    count += compress_store(hn::LoadU(du, rays.point.data() + k), hn::RebindMask(du, kept), du, point + count);
  }
  return count;
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
HWY_EXPORT(TurnRays);
}  // namespace sightline
namespace sightline::square_lights {

std::size_t turn_rays(const DiskRays& rays, const Frame3& frame, const Vec3* side, Vec3Batch& direction, std::uint32_t* point) {
  return HWY_DYNAMIC_DISPATCH(TurnRays)(rays, frame, side, direction, point);
}

}  // namespace sightline::square_lights
#endif
