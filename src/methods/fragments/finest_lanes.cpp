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

FinestTerms Terms(const FinestRun& run, bool weigh, float* HWY_RESTRICT term, std::uint32_t* HWY_RESTRICT light_of) {
  const D d;
  const DU du;
  const V zero = hn::Zero(d), red = hn::Set(d, 0.2126f), green = hn::Set(d, 0.7152f), blue = hn::Set(d, 0.0722f);
  const V3 ns = set3(d, run.shading_normal), ng = set3(d, run.geometric_normal);
  V all = zero;
  FinestTerms terms;
  for (std::size_t k = 0; k < run.count; k += hn::Lanes(d)) {
    const std::size_t i = run.first + k;
    const M valid = hn::FirstN(d, run.count - k);
    const V3 wi = load3(d, run.light.wi, i);
    const V cosine = dot3(wi, ns), pdf = hn::LoadU(d, run.light.pdf.data() + i);
    const M reaches = hn::And(hn::And(valid, hn::Gt(cosine, zero)), hn::And(hn::Gt(dot3(wi, ng), zero), hn::Gt(pdf, zero)));
    V value = hn::Div(hn::Mul(cosine, hn::Set(d, kInvPi)), pdf);
    if (weigh) {
      const V3 radiance = load3(d, run.light.radiance, i);
      value = hn::Mul(value, hn::MulAdd(radiance.x, red, hn::MulAdd(radiance.y, green, hn::Mul(radiance.z, blue))));
    }
    value = hn::IfThenElseZero(reaches, value);
    const M positive = hn::Gt(value, zero);
    all = hn::Add(all, value);
    terms.asked += static_cast<std::uint32_t>(hn::CountTrue(d, positive));
    const auto index = hn::Iota(du, static_cast<std::uint32_t>(i));
    hn::BlendedStore(value, valid, d, term + i);
    hn::BlendedStore(hn::IfThenElse(hn::RebindMask(du, positive), index, hn::Set(du, kNoQuery)), hn::RebindMask(du, valid), du,
                     light_of + i);
  }
  terms.all = hn::GetLane(hn::SumOfLanes(d, all));
  return terms;
}

FinestSum Sum(const FinestRun& run, bool irradiance, const float* HWY_RESTRICT term, const float* HWY_RESTRICT weight) {
  const D d;
  const V zero = hn::Zero(d);
  V visible = zero;
  V3 light = {zero, zero, zero};
  FinestSum sum;
  for (std::size_t k = 0; k < run.count; k += hn::Lanes(d)) {
    const std::size_t i = run.first + k;
    const M seen = hn::And(hn::FirstN(d, run.count - k), hn::Gt(hn::LoadU(d, weight + i), hn::Set(d, 0.5f)));
    const V value = hn::IfThenElseZero(seen, hn::LoadU(d, term + i));
    visible = hn::Add(visible, value);
    sum.seen += static_cast<std::uint32_t>(hn::CountTrue(d, seen));
    if (irradiance) light = add3(light, scale3(load3(d, run.light.radiance, i), value));
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
