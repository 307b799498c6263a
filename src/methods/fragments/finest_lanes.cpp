#include "methods/fragments/finest_lanes.h"

#include "visibility/query_batch.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "methods/fragments/finest_lanes.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "base/simd/vec3-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

using namespace lanes;

// kUniform: what the points have in common is read once.
template <bool kUniform>
FinestTerms terms_of(const FinestRun& run, bool weigh, float* HWY_RESTRICT term, std::uint32_t* HWY_RESTRICT light_of) {
  const D d;
  const DU du;
  const V zero = hn::Zero(d);
  const V3 p = set3(d, run.position), ns = set3(d, run.shading_normal), ng = set3(d, run.geometric_normal);
  const float* HWY_RESTRICT weights = weigh ? run.points.power.data() : run.points.area.data();
  V3 normal = set3(d, run.ends.normal, 0);
  V weight = hn::Mul(hn::Set(d, weights[0]), hn::Set(d, kInvPi));
  M both = hn::Gt(hn::Set(d, run.points.two_sided[0]), zero);
  V all = zero;
  FinestTerms terms;
  for (std::size_t k = 0; k < run.count; k += hn::Lanes(d)) {
    const std::size_t i = run.first + k;
    const M valid = hn::FirstN(d, run.count - k);
    if constexpr (!kUniform) {
      normal = load3(d, run.ends.normal, i), weight = hn::Mul(hn::LoadU(d, weights + i), hn::Set(d, kInvPi));
      both = hn::Gt(hn::LoadU(d, run.points.two_sided.data() + i), zero);
    }
    const V3 towards = sub3(load3(d, run.ends.position, i), p);
    const V cosine = dot3(towards, ns), side = dot3(towards, ng), behind = dot3(towards, normal);
    const V away = hn::IfThenElse(both, hn::Abs(behind), hn::Neg(behind)), squared = dot3(towards, towards);
    const M reaches = hn::And(hn::And(valid, hn::Gt(cosine, zero)), hn::And(hn::Gt(side, zero), hn::Gt(away, zero)));
    const V geometry = hn::Div(hn::Mul(cosine, away), hn::Mul(squared, squared));
    const V value = hn::IfThenElseZero(reaches, hn::Mul(geometry, weight));
    const M positive = hn::Gt(value, zero);
    all = hn::Add(all, value);
    terms.asked += static_cast<std::uint32_t>(hn::CountTrue(d, positive));
    const auto index = hn::Iota(du, static_cast<std::uint32_t>(i));
    const auto asked = hn::IfThenElse(hn::RebindMask(du, positive), index, hn::Set(du, kNoQuery));
    if (run.count - k >= hn::Lanes(d)) {
      hn::StoreU(value, d, term + run.lane + k), hn::StoreU(asked, du, light_of + run.lane + k);
    } else {
      hn::BlendedStore(value, valid, d, term + run.lane + k);
      hn::BlendedStore(asked, hn::RebindMask(du, valid), du, light_of + run.lane + k);
    }
  }
  terms.all = hn::GetLane(hn::SumOfLanes(d, all));
  return terms;
}

FinestTerms Terms(const FinestRun& run, bool weigh, float* HWY_RESTRICT term, std::uint32_t* HWY_RESTRICT light_of) {
  return run.points.uniform() ? terms_of<true>(run, weigh, term, light_of) : terms_of<false>(run, weigh, term, light_of);
}

FinestSum Sum(const FinestRun& run, bool irradiance, const float* HWY_RESTRICT term, const float* HWY_RESTRICT weight) {
  const D d;
  const V zero = hn::Zero(d);
  V visible = zero;
  V3 light = {zero, zero, zero};
  FinestSum sum;
  for (std::size_t k = 0; k < run.count; k += hn::Lanes(d)) {
    const std::size_t lane = run.lane + k;
    const M seen = hn::And(hn::FirstN(d, run.count - k), hn::Gt(hn::LoadU(d, weight + lane), hn::Set(d, 0.5f)));
    const V value = hn::IfThenElseZero(seen, hn::LoadU(d, term + lane));
    visible = hn::Add(visible, value);
    sum.seen += static_cast<std::uint32_t>(hn::CountTrue(d, seen));
    if (irradiance) light = add3(light, scale3(load3(d, run.points.radiance, run.first + k), value));
  }
  sum.visible = hn::GetLane(hn::SumOfLanes(d, visible));
  if (irradiance)
    sum.irradiance = {hn::GetLane(hn::SumOfLanes(d, light.x)), hn::GetLane(hn::SumOfLanes(d, light.y)),
                      hn::GetLane(hn::SumOfLanes(d, light.z))};
  return sum;
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
HWY_EXPORT(Terms);
HWY_EXPORT(Sum);

FinestTerms finest_terms(const FinestRun& run, bool weigh, float* term, std::uint32_t* light_of) {
  return HWY_DYNAMIC_DISPATCH(Terms)(run, weigh, term, light_of);
}
FinestSum finest_sum(const FinestRun& run, bool irradiance, const float* term, const float* weight) {
  return HWY_DYNAMIC_DISPATCH(Sum)(run, irradiance, term, weight);
}

}  // namespace sightline
#endif
