#include "methods/square_lights/near_lanes.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "methods/square_lights/near_lanes.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "base/simd/vec3-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::square_lights::HWY_NAMESPACE {

using namespace sightline::HWY_NAMESPACE::lanes;

HWY_INLINE V3 CenterAt(D d, const LightSet& lights, std::size_t i) {
  return {hn::Load(d, lights.x.data() + i), hn::Load(d, lights.y.data() + i), hn::Load(d, lights.z.data() + i)};
}

HWY_INLINE hn::Vec<DU> IndexAt(DU du, std::size_t i) { return hn::Add(hn::Iota(du, 0), hn::Set(du, static_cast<std::uint32_t>(i))); }

HWY_ATTR std::size_t FindActive(const LightSet& lights, const Vec3& normal, float plane_scale, const float* value, float least_by_radius,
                                float* on, std::uint32_t* index) {
  const D d;
  const DU du;
  const V one = hn::Set(d, 1.f), scale = hn::Set(d, plane_scale), least = hn::Set(d, least_by_radius);
  const V3 up = set3(d, normal);
  std::size_t count = 0;
  for (std::size_t i = 0; i < lights.x.size(); i += hn::Lanes(d)) {
    const V r = hn::Mul(hn::Load(d, lights.r.data() + i), scale), horizon = hn::Add(one, r);
    const V z = dot3(CenterAt(d, lights, i), up);
    const M above = hn::Lt(hn::Sub(one, z), hn::Mul(horizon, horizon));
    const M seen = hn::Gt(hn::LoadU(d, value + i), hn::Mul(least, r));
    M kept = hn::And(above, seen);
    if (i + hn::Lanes(d) > lights.count) kept = hn::And(kept, hn::FirstN(d, lights.count > i ? lights.count - i : 0));
    hn::StoreU(hn::IfThenElseZero(kept, one), d, on + i);
    count += compress_store(IndexAt(du, i), hn::RebindMask(du, kept), du, index + count);
  }
  return count;
}

HWY_ATTR std::size_t FindNear(const LightSet& lights, const float* on, const float* may, const ReachLanes& reach, const OccluderCone& cone,
                              const Mat3& turn, NearLights& near) {
  const D d;
  const DU du;
  const V zero = hn::Zero(d);
  const V3 to = set3(d, cone.to);
  const V distance = hn::Set(d, cone.distance), sine = hn::Set(d, cone.sine), cosine = hn::Set(d, cone.cosine);
  const V3 turn_x = set3(d, {turn[0].x, turn[1].x, turn[2].x}), turn_y = set3(d, {turn[0].y, turn[1].y, turn[2].y}),
           turn_z = set3(d, {turn[0].z, turn[1].z, turn[2].z});
  std::size_t count = 0;
  for (std::size_t i = 0; i < lights.x.size(); i += hn::Lanes(d)) {
    M kept = hn::Gt(hn::Min(hn::LoadU(d, on + i), hn::LoadU(d, may + i)), zero);
    if (hn::AllFalse(d, kept)) continue;
    const V3 c = CenterAt(d, lights, i);
    if (!cone.inside) {
      // Outside the cones of light and occluder, both of which are narrower than half a sphere.
      const V reach_cosine = hn::Load(d, reach.cosine.data() + i), reach_sine = hn::Load(d, reach.sine.data() + i);
      const V farthest = hn::Mul(distance, hn::Sub(hn::Mul(cosine, reach_cosine), hn::Mul(sine, reach_sine)));
      const M away = hn::And(hn::Gt(reach_cosine, hn::Set(d, 0.1f)), hn::Lt(dot3(c, to), farthest));
      kept = hn::AndNot(away, kept);
      if (hn::AllFalse(d, kept)) continue;
    }
    compress_store(dot3(turn_x, c), kept, d, near.x.data() + count);
    compress_store(dot3(turn_y, c), kept, d, near.y.data() + count);
    compress_store(dot3(turn_z, c), kept, d, near.z.data() + count);
    compress_store(hn::Load(d, lights.r.data() + i), kept, d, near.r.data() + count);
    count += compress_store(IndexAt(du, i), hn::RebindMask(du, kept), du, near.index.data() + count);
  }
  if (count == 0) return 0;
  for (AlignedVector<float>* values : {&near.x, &near.y, &near.z, &near.r}) {
    const V last = hn::Set(d, (*values)[count - 1]);
    for (std::size_t i = count; i < padded(count); i += hn::Lanes(d)) hn::StoreU(last, d, values->data() + i);
  }
  return count;
}

}  // namespace sightline::square_lights::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::square_lights {
HWY_EXPORT(FindActive);
HWY_EXPORT(FindNear);

void find_active(const LightSet& lights, const Vec3& normal, float plane_scale, std::span<const float> value, float least_by_radius,
                 ActiveLights& active) {
  // A compressing store may write a whole vector.
  const std::size_t room = lights.x.size() + kLanes;
  if (active.index.size() < room) active.on.resize(room), active.index.resize(room);
  active.count =
      HWY_DYNAMIC_DISPATCH(FindActive)(lights, normal, plane_scale, value.data(), least_by_radius, active.on.data(), active.index.data());
}

void find_near(const LightSet& lights, const ActiveLights& active, std::span<const float> may, const ReachLanes& reach,
               const OccluderCone& cone, const Mat3& turn, NearLights& near) {
  const std::size_t room = lights.x.size() + 2 * kLanes;
  if (near.index.size() < room) {
    for (AlignedVector<float>* values : {&near.x, &near.y, &near.z, &near.r}) values->resize(room);
    near.index.resize(room);
  }
  near.count = HWY_DYNAMIC_DISPATCH(FindNear)(lights, active.on.data(), may.data(), reach, cone, turn, near);
}

}  // namespace sightline::square_lights
#endif
