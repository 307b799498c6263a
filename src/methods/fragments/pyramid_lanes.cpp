#include "methods/fragments/pyramid_lanes.h"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "methods/fragments/pyramid_lanes.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "base/simd/vec3-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

using namespace lanes;

void Discontinuities(const GBuffer& g, const DiscontinuityRow& row, float* HWY_RESTRICT kappa, float* HWY_RESTRICT dz,
                     std::uint8_t* HWY_RESTRICT any, std::uint8_t* HWY_RESTRICT flat) {
  const D d;
  const DU du;
  const auto bytes = hn::Rebind<std::uint8_t, D>();
  const V zero = hn::Zero(d), infinity = hn::Set(d, std::numeric_limits<float>::infinity());
  static_assert(static_cast<int>(PixelKind::diffuse) + 1 == static_cast<int>(PixelKind::analytic));
  const auto* kinds = reinterpret_cast<const std::uint8_t*>(g.kind.data());
  const auto kinds_at = [&](std::size_t at) { return hn::PromoteTo(du, hn::LoadU(bytes, kinds + at)); };
  const auto interpolated = [&](hn::Vec<DU> kind) {
    const auto diffuse = hn::Set(du, static_cast<std::uint32_t>(PixelKind::diffuse));
    const auto analytic = hn::Set(du, static_cast<std::uint32_t>(PixelKind::analytic));
    return hn::Or(hn::Eq(kind, diffuse), hn::Eq(kind, analytic));
  };
  for (std::size_t i = 0; i < row.count; i += hn::Lanes(d)) {
    const std::size_t here = row.first + i;
    const auto kind = kinds_at(here);
    const auto surface_bits = interpolated(kind);
    const M surface = hn::RebindMask(d, surface_bits);
    const V3 p = load3(d, g.position, here), ng = load3(d, g.geometric_normal, here), ns = load3(d, g.shading_normal, here);
    const V depth = hn::LoadU(d, g.depth.data() + here);
    V bend = zero, step = zero;
    M uneven = hn::Lt(zero, zero);
    const auto compare = [&](std::size_t there, M valid) {
      const auto other_kind = kinds_at(there);
      const M other = hn::RebindMask(d, interpolated(other_kind)), same = hn::RebindMask(d, hn::Eq(kind, other_kind));
      // Between surfaces of two kinds, or a surface and something else.
      const M broken = hn::And(valid, hn::AndNot(same, hn::Or(surface, other)));
      const M smooth = hn::And(hn::And(valid, surface), same);
      const V3 change = sub3(ns, load3(d, g.shading_normal, there));
      bend = hn::Add(bend, hn::IfThenElseZero(smooth, dot3(change, change)));
      const V3 towards = sub3(load3(d, g.position, there), p);
      const V from_plane = dot3(towards, ng), away = row.plane_distance ? from_plane : hn::Sub(hn::LoadU(d, g.depth.data() + there), depth);
      const V squared = dot3(towards, towards);
      const M steep = hn::Gt(hn::Mul(from_plane, from_plane), hn::Mul(squared, hn::Set(d, kFlatSlope * kFlatSlope)));
      const M far = hn::Gt(squared, hn::Mul(hn::Mul(depth, depth), hn::Set(d, kFlatReach * kFlatReach)));
      uneven = hn::Or(uneven, hn::And(valid, hn::Or(steep, far)));
      step = hn::Max(step, hn::IfThenElseZero(smooth, hn::Div(hn::Abs(away), depth)));
      bend = hn::IfThenElse(broken, infinity, bend), step = hn::IfThenElse(broken, infinity, step);
    };
    const std::size_t left = row.count - i;
    compare(here + 1, hn::FirstN(d, row.right_edge ? left - 1 : left));
    if (!row.lower_edge) compare(here + static_cast<std::size_t>(g.stride), hn::FirstN(d, left));
    hn::StoreU(hn::Sqrt(bend), d, kappa + i), hn::StoreU(step, d, dz + i);
    const auto as_bytes = [&](hn::Mask<DU> mask) {
      return hn::DemoteTo(bytes, hn::BitCast(DI(), hn::IfThenElseZero(mask, hn::Set(du, 1u))));
    };
    hn::StoreU(as_bytes(hn::And(surface_bits, hn::FirstN(du, left))), bytes, any + i);
    if (!flat) continue;
    const M even = hn::AndNot(uneven, hn::Le(bend, hn::Set(d, kFlatBend * kFlatBend)));
    hn::StoreU(as_bytes(hn::And(surface_bits, hn::RebindMask(du, even))), bytes, flat + i);
  }
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
HWY_EXPORT(Discontinuities);

void discontinuities(const GBuffer& g, const DiscontinuityRow& row, float* kappa, float* dz, std::uint8_t* any, std::uint8_t* flat) {
  HWY_DYNAMIC_DISPATCH(Discontinuities)(g, row, kappa, dz, any, flat);
}

}  // namespace sightline
#endif
