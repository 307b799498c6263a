#include "methods/fragments/camera_lanes.h"

#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "methods/fragments/camera_lanes.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "base/simd/vec3-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

using namespace lanes;

void TurnNormals(const Vec3Batch& direction, std::size_t count, SurfaceBatch& surfaces, HitBatch& hits, std::uint8_t* HWY_RESTRICT back) {
  const D d;
  const DU du;
  const auto bytes = hn::Rebind<std::uint8_t, D>();
  const V zero = hn::Zero(d), one = hn::Set(d, 1.f), infinity = hn::Set(d, std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const V3 to = load3(d, direction, i), ng = load3(d, surfaces.geometric_normal, i), ns = load3(d, surfaces.shading_normal, i);
    const V by_geometric = dot3(to, ng), by_shading = dot3(to, ns);
    const M behind = hn::Gt(by_geometric, zero), usable = hn::Gt(hn::Mul(by_shading, by_geometric), zero);
    const V side = hn::IfThenElse(behind, hn::Neg(one), one);
    store3(d, scale3(ng, side), surfaces.geometric_normal, i);
    store3(d, scale3(select3(usable, ns, ng), side), surfaces.shading_normal, i);
    const auto missed = hn::Eq(hn::LoadU(du, hits.instance.data() + i), hn::Set(du, kNoHit));
    hn::StoreU(hn::IfThenElse(hn::RebindMask(d, missed), infinity, hn::LoadU(d, hits.t.data() + i)), d, hits.t.data() + i);
    const auto ones = hn::IfThenElseZero(hn::RebindMask(du, behind), hn::Set(du, 1u));
    hn::StoreU(hn::DemoteTo(bytes, hn::BitCast(DI(), ones)), bytes, back + i);
  }
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
HWY_EXPORT(TurnNormals);

void turn_normals(const Vec3Batch& direction, std::size_t count, SurfaceBatch& surfaces, HitBatch& hits, std::uint8_t* back) {
  HWY_DYNAMIC_DISPATCH(TurnNormals)(direction, count, surfaces, hits, back);
}

}  // namespace sightline
#endif
