#include "visibility/query_ray_lanes.h"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "visibility/query_ray_lanes.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "base/simd/vec3-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

using namespace lanes;

using I = hn::Vec<DI>;

// offset_origin() of world/surface.h, operation by operation.
HWY_INLINE V3 offset(D d, const V3& p, const V3& n, V error, const V3& direction) {
  const V distance = hn::Mul(error, hn::Add(hn::Add(hn::Abs(n.x), hn::Abs(n.y)), hn::Abs(n.z)));
  const V s = hn::IfThenElse(hn::Ge(dot3(direction, n), hn::Zero(d)), distance, hn::Neg(distance));
  return {hn::Add(p.x, hn::Mul(s, n.x)), hn::Add(p.y, hn::Mul(s, n.y)), hn::Add(p.z, hn::Mul(s, n.z))};
}

struct End {
  V3 position, normal;
  V error;
};

/// Elements of arrays at indices that are at most two vectors apart: two loads and permutations cost much less than a gather.
struct NearPicker {
  D d;
  std::size_t at;
  M upper;
  decltype(hn::IndicesFromVec(D(), I())) index;
  HWY_INLINE NearPicker(D df, std::size_t first, I offset)
      : d(df),
        at(first),
        upper(hn::RebindMask(df, hn::Gt(offset, hn::Set(DI(), static_cast<std::int32_t>(hn::Lanes(df)) - 1)))),
        index(hn::IndicesFromVec(df, hn::And(offset, hn::Set(DI(), static_cast<std::int32_t>(hn::Lanes(df)) - 1)))) {}
  HWY_INLINE V operator()(const float* array) const {
    return hn::IfThenElse(upper, hn::TableLookupLanes(hn::LoadU(d, array + at + hn::Lanes(d)), index),
                          hn::TableLookupLanes(hn::LoadU(d, array + at), index));
  }
  HWY_INLINE V3 operator()(const Vec3Batch& b) const { return {(*this)(b.x.data()), (*this)(b.y.data()), (*this)(b.z.data())}; }
};

// Ends of 16 queries. Runs of queries mostly share one end, or go through the ends in order, with gaps where there is no contribution:
// reading those is much less than gathering.
HWY_INLINE End ends_at(D d, const QueryEnds& ends, I index) {
  const DI di;
  const std::int32_t first = hn::GetLane(index);
  const auto at = static_cast<std::size_t>(first);
  if (hn::AllTrue(di, hn::Eq(index, hn::Set(di, first)))) {
    const auto set = [&](const Vec3Batch& b) { return V3{hn::Set(d, b.x[at]), hn::Set(d, b.y[at]), hn::Set(d, b.z[at])}; };
    return {set(ends.position), set(ends.normal), hn::Set(d, ends.error[at])};
  }
  if (hn::AllTrue(di, hn::Eq(index, hn::Add(hn::Iota(di, 0), hn::Set(di, first)))))
    return {load3(d, ends.position, at), load3(d, ends.normal, at), hn::LoadU(d, ends.error.data() + at)};
  const std::size_t reach = 2 * hn::Lanes(d), readable = padded(ends.size);
  if (readable >= reach) {
    const std::size_t from = std::min(at, readable - reach);
    const I offset = hn::Sub(index, hn::Set(di, static_cast<std::int32_t>(from)));
    const auto near = hn::And(hn::Gt(offset, hn::Set(di, -1)), hn::Lt(offset, hn::Set(di, static_cast<std::int32_t>(reach))));
    if (hn::AllTrue(di, near)) {
      const NearPicker pick(d, from, offset);
      return {pick(ends.position), pick(ends.normal), pick(ends.error.data())};
    }
  }
  return {gather3(d, ends.position, index), gather3(d, ends.normal, index), hn::GatherIndex(d, ends.error.data(), index)};
}

// Lanes whose light end is a direction. Semantics are bytes: few enough to look up one by one, where lights differ.
HWY_INLINE M infinite_at(D d, const QueryBatch& queries, I light) {
  const DI di;
  alignas(kCacheLine) std::int32_t index[kLanes];
  hn::Store(light, di, index);
  const auto infinite = [&](std::size_t k) {
    return is_infinite(static_cast<QuerySemantic>(queries.semantic[static_cast<std::size_t>(index[k])]));
  };
  if (hn::AllTrue(di, hn::Eq(light, hn::Set(di, index[0]))))
    return hn::RebindMask(d, hn::Eq(light, hn::Set(di, infinite(0) ? index[0] : -1)));
  for (std::size_t k = 0; k < hn::Lanes(d); ++k) index[k] = infinite(k);
  return hn::RebindMask(d, hn::Ne(hn::Load(di, index), hn::Zero(di)));
}

HWY_INLINE void store_rays(D d, const V3& origin, const V3& direction, V t_far, RayBatch& rays, std::size_t i) {
  store3(d, origin, rays.origin, i);
  store3(d, direction, rays.direction, i);
  hn::StoreU(hn::Zero(d), d, rays.t_near.data() + i);
  hn::StoreU(t_far, d, rays.t_far.data() + i);
}

// kAnyInfinite: false where no light end of the batch is a direction.
template <bool kAnyInfinite>
void make_rays(const QueryBatch& queries, const std::uint32_t* which, std::size_t first, std::size_t count, RayBatch& rays) {
  const D d;
  const DI di;
  const V one = hn::Set(d, 1.f), infinity = hn::Set(d, std::numeric_limits<float>::infinity());
  const auto* eye_of = reinterpret_cast<const std::int32_t*>(queries.eye_of.data());
  const auto* light_of = reinterpret_cast<const std::int32_t*>(queries.light_of.data());
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    I e, named;
    if (!which && i + hn::Lanes(d) <= count) {
      e = hn::LoadU(di, eye_of + first + i), named = hn::LoadU(di, light_of + first + i);
    } else {
      // Lanes beyond the end repeat the last query.
      const I lane =
          hn::Min(hn::Add(hn::Iota(di, 0), hn::Set(di, static_cast<std::int32_t>(i))), hn::Set(di, static_cast<std::int32_t>(count) - 1));
      const I query = which ? hn::GatherIndex(di, reinterpret_cast<const std::int32_t*>(which), lane)
                            : hn::Add(lane, hn::Set(di, static_cast<std::int32_t>(first)));
      e = hn::GatherIndex(di, eye_of, query), named = hn::GatherIndex(di, light_of, query);
    }
    const auto gap = hn::Lt(named, hn::Zero(di));
    const I l = hn::IfThenZeroElse(gap, named);
    const End eye = ends_at(d, queries.eye, e), light = ends_at(d, queries.light, l);
    V3 towards = sub3(light.position, eye.position);
    M far = hn::Lt(one, hn::Zero(d));
    if constexpr (kAnyInfinite) far = infinite_at(d, queries, l), towards = select3(far, light.position, towards);
    const V3 origin = offset(d, eye.position, eye.normal, eye.error, towards);
    const V3 back = {hn::Neg(towards.x), hn::Neg(towards.y), hn::Neg(towards.z)};
    V3 direction = sub3(offset(d, light.position, light.normal, light.error, back), origin);
    V t_far = one;
    if constexpr (kAnyInfinite) direction = select3(far, light.position, direction), t_far = hn::IfThenElse(far, infinity, one);
    if (hn::AllFalse(di, gap)) {
      store_rays(d, origin, direction, t_far, rays, i);
    } else {
      const M hole = hn::RebindMask(d, gap);
      const V zero = hn::Zero(d);
      store_rays(d, select3(hole, {zero, zero, zero}, origin), select3(hole, {zero, zero, one}, direction),
                 hn::IfThenElse(hole, hn::Neg(one), t_far), rays, i);
    }
  }
}

void QueryRays(const QueryBatch& queries, const std::uint32_t* which, std::size_t first, std::size_t count, RayBatch& rays) {
  // A loop that compilers make vectors of: it runs for every group of misses.
  static_assert(is_infinite(QuerySemantic::direction) && is_infinite(QuerySemantic::solid_angle));
  constexpr auto kDirection = static_cast<std::uint8_t>(QuerySemantic::direction);
  constexpr auto kSolidAngle = static_cast<std::uint8_t>(QuerySemantic::solid_angle);
  static_assert(!is_infinite(QuerySemantic::point) && !is_infinite(QuerySemantic::surface));
  const std::uint8_t* HWY_RESTRICT semantic = queries.semantic.data();
  std::uint8_t any = 0;
  for (std::size_t i = 0; i < queries.light.size; ++i)
    any = static_cast<std::uint8_t>(any | (semantic[i] == kDirection) | (semantic[i] == kSolidAngle));
  if (any)
    make_rays<true>(queries, which, first, count, rays);
  else
    make_rays<false>(queries, which, first, count, rays);
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
