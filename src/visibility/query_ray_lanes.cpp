#include "visibility/query_ray_lanes.h"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "visibility/query_ray_lanes.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, kLanes>;
using DI = hn::RebindToSigned<D>;
using V = hn::Vec<D>;
using I = hn::Vec<DI>;

struct V3 {
  V x, y, z;
};

HWY_INLINE V3 gather3(D d, const Vec3Batch& batch, I index) {
  return {hn::GatherIndex(d, batch.x.data(), index), hn::GatherIndex(d, batch.y.data(), index), hn::GatherIndex(d, batch.z.data(), index)};
}
HWY_INLINE V3 sub(const V3& a, const V3& b) { return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)}; }
HWY_INLINE V dot(const V3& a, const V3& b) { return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z)); }

// offset_origin() of world/surface.h, operation by operation.
HWY_INLINE V3 offset(D d, const V3& p, const V3& n, V error, const V3& direction) {
  const V distance = hn::Mul(error, hn::Add(hn::Add(hn::Abs(n.x), hn::Abs(n.y)), hn::Abs(n.z)));
  const V s = hn::IfThenElse(hn::Ge(dot(direction, n), hn::Zero(d)), distance, hn::Neg(distance));
  return {hn::Add(p.x, hn::Mul(s, n.x)), hn::Add(p.y, hn::Mul(s, n.y)), hn::Add(p.z, hn::Mul(s, n.z))};
}

void QueryRays(const QueryBatch& queries, const std::uint32_t* which, std::size_t first, std::size_t count, RayBatch& rays) {
  const D d;
  const DI di;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.f), infinity = hn::Set(d, std::numeric_limits<float>::infinity());
  const auto* eye_of = reinterpret_cast<const std::int32_t*>(queries.eye_of.data());
  const auto* light_of = reinterpret_cast<const std::int32_t*>(queries.light_of.data());
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    // Lanes beyond the end repeat the last query.
    const I lane =
        hn::Min(hn::Add(hn::Iota(di, 0), hn::Set(di, static_cast<std::int32_t>(i))), hn::Set(di, static_cast<std::int32_t>(count) - 1));
    const I query = which ? hn::GatherIndex(di, reinterpret_cast<const std::int32_t*>(which), lane)
                          : hn::Add(lane, hn::Set(di, static_cast<std::int32_t>(first)));
    const I e = hn::GatherIndex(di, eye_of, query), named = hn::GatherIndex(di, light_of, query);
    const auto gap = hn::Lt(named, hn::Zero(di));
    const I l = hn::IfThenElse(gap, hn::Zero(di), named);
    // Semantics are bytes: few enough to look up one by one.
    alignas(kCacheLine) std::int32_t light_index[kLanes], infinite[kLanes];
    hn::Store(l, di, light_index);
    for (std::size_t k = 0; k < hn::Lanes(d); ++k)
      infinite[k] = is_infinite(static_cast<QuerySemantic>(queries.semantic[static_cast<std::size_t>(light_index[k])]));
    const auto far = hn::RebindMask(d, hn::Ne(hn::Load(di, infinite), hn::Zero(di)));

    const V3 x = gather3(d, queries.eye.position, e), nx = gather3(d, queries.eye.normal, e);
    const V3 y = gather3(d, queries.light.position, l), ny = gather3(d, queries.light.normal, l);
    const V3 between = sub(y, x);
    const V3 towards = {hn::IfThenElse(far, y.x, between.x), hn::IfThenElse(far, y.y, between.y), hn::IfThenElse(far, y.z, between.z)};
    const V3 origin = offset(d, x, nx, hn::GatherIndex(d, queries.eye.error.data(), e), towards);
    const V3 back = {hn::Neg(towards.x), hn::Neg(towards.y), hn::Neg(towards.z)};
    const V3 target = offset(d, y, ny, hn::GatherIndex(d, queries.light.error.data(), l), back);
    const V3 direction = sub(target, origin);
    const auto hole = hn::RebindMask(d, gap);
    const auto put = [&](V v, AlignedVector<float>& to) { hn::Store(v, d, to.data() + i); };
    put(hn::IfThenZeroElse(hole, origin.x), rays.origin.x), put(hn::IfThenZeroElse(hole, origin.y), rays.origin.y);
    put(hn::IfThenZeroElse(hole, origin.z), rays.origin.z);
    put(hn::IfThenZeroElse(hole, hn::IfThenElse(far, y.x, direction.x)), rays.direction.x);
    put(hn::IfThenZeroElse(hole, hn::IfThenElse(far, y.y, direction.y)), rays.direction.y);
    put(hn::IfThenElse(hole, one, hn::IfThenElse(far, y.z, direction.z)), rays.direction.z);
    put(zero, rays.t_near);
    put(hn::IfThenElse(hole, hn::Neg(one), hn::IfThenElse(far, infinity, one)), rays.t_far);
  }
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
HWY_EXPORT(QueryRays);

void query_rays(const QueryBatch& queries, const std::uint32_t* which, std::size_t first, std::size_t count, RayBatch& rays) {
  if (count > 0) HWY_DYNAMIC_DISPATCH(QueryRays)(queries, which, first, count, rays);
}

}  // namespace sightline
#endif
