#include "methods/visibility_cache/eye_lanes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "methods/visibility_cache/eye_lanes.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "base/simd/vec3-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

using namespace lanes;

/// A Lambert eye point in all lanes.
struct EyeV {
  V3 normal, geometric, color;  ///< color: throughput times reflectance
  float wo_normal, wo_geometric;
};

HWY_INLINE EyeV eye_of(D d, const EyeSample& eye) {
  const Color color = eye.weight * eye.bsdf.lambert()->reflectance;
  return {set3(d, eye.frame.normal), set3(d, eye.geometric_normal), set3(d, color), glm::dot(eye.wo, eye.frame.normal),
          glm::dot(eye.wo, eye.geometric_normal)};
}

/// Reflection by the shading normal and by the geometric one.
HWY_INLINE M reflects(D d, const EyeV& eye, V cos_normal, V cos_geometric) {
  return hn::And(hn::Gt(hn::Mul(hn::Set(d, eye.wo_normal), cos_normal), hn::Zero(d)),
                 hn::Gt(hn::Mul(hn::Set(d, eye.wo_geometric), cos_geometric), hn::Zero(d)));
}

HWY_INLINE void append(D d, const V3& value, M keep, std::uint32_t eye_index, hn::Vec<DU> light, Contributions& out) {
  keep = hn::And(keep, hn::Gt(max3(value), hn::Zero(d)));
  if (hn::AllFalse(d, keep)) return;
  const DU du;
  compress_store3(d, value, keep, out.color, out.size);
  hn::StoreU(hn::Set(du, eye_index), du, out.eye.data() + out.size);
  out.size += hn::CompressStore(light, hn::RebindMask(du, keep), du, out.light.data() + out.size);
}

void AppendSamples(const EyeSample& sample, std::uint32_t eye_index, const LightSampleBatch& lights, std::size_t first, std::size_t count,
                   std::uint32_t number, const SampleWeights& weights, Contributions& out) {
  const D d;
  const DU du;
  const EyeV eye = eye_of(d, sample);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const V3 wi = load3(d, lights.wi, first + i);
    const V pdf = hn::LoadU(d, lights.pdf.data() + first + i);
    const V cosine = dot3(wi, eye.normal);
    M keep = hn::And(hn::FirstN(d, count - i), hn::Gt(pdf, hn::Zero(d)));
    keep = hn::And(keep, reflects(d, eye, cosine, dot3(wi, eye.geometric)));
    if (hn::AllFalse(d, keep)) continue;
    const V bsdf_pdf = hn::Mul(hn::Abs(cosine), hn::Set(d, kInvPi));
    V scale = hn::Div(hn::Mul(bsdf_pdf, hn::Set(d, weights.scale)), pdf);
    if (weights.mis_bsdf > 0) {
      const V own = hn::Mul(pdf, hn::Set(d, weights.mis_light));
      scale = hn::Mul(scale, hn::Div(own, hn::MulAdd(bsdf_pdf, hn::Set(d, weights.mis_bsdf), own)));
    }
    const V3 value = scale3(mul3(load3(d, lights.radiance, first + i), eye.color), scale);
    append(d, value, keep, eye_index, hn::Add(hn::Iota(du, number), hn::Set(du, static_cast<std::uint32_t>(i))), out);
  }
}

void AppendVirtualLights(const EyeSample& sample, std::uint32_t eye_index, const VirtualPointLights& lights, Contributions& out) {
  const D d;
  const DU du;
  const hn::Rebind<std::uint8_t, D> bytes;
  const EyeV eye = eye_of(d, sample);
  const V3 position = set3(d, sample.position);
  const V most = hn::Set(d, lights.max_geometry_term), zero = hn::Zero(d);
  for (std::size_t i = 0; i < lights.size; i += hn::Lanes(d)) {
    const V3 to = sub3(load3(d, lights.position, i), position);
    const V squared = dot3(to, to);
    const V distance = hn::Sqrt(squared);
    const V inverse = hn::Div(hn::Set(d, 1.f), distance);
    const V cosine = hn::Mul(dot3(to, eye.normal), inverse);
    const V sent = hn::Neg(hn::Mul(dot3(to, load3(d, lights.normal, i)), inverse));
    M keep = hn::And(hn::FirstN(d, lights.size - i), hn::And(hn::Gt(sent, zero), hn::Gt(squared, zero)));
    keep = hn::And(keep, hn::RebindMask(d, hn::Ne(hn::PromoteTo(du, hn::LoadU(bytes, lights.lambert.data() + i)), hn::Zero(du))));
    keep = hn::And(keep, reflects(d, eye, cosine, dot3(to, eye.geometric)));
    if (hn::AllFalse(d, keep)) continue;
    const V geometry = hn::Min(hn::Div(hn::Mul(hn::Abs(cosine), sent), squared), most);
    const V3 value = scale3(mul3(load3(d, lights.radiosity, i), eye.color), hn::Mul(geometry, hn::Set(d, kInvPi)));
    append(d, value, keep, eye_index, hn::Add(hn::Iota(du, 0u), hn::Set(du, static_cast<std::uint32_t>(i))), out);
  }
}

Color WeightedSum(const Contributions& c, const float* weights, std::size_t begin, std::size_t end) {
  const D d;
  V3 sum = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  for (std::size_t i = begin; i < end; i += hn::Lanes(d)) {
    const M inside = hn::FirstN(d, end - i);
    const V w = hn::IfThenElseZero(inside, hn::LoadU(d, weights + i));
    const V3 color = load3(d, c.color, i);
    // What lies beyond the end may be anything, not-a-number too.
    sum = add3(sum, {hn::IfThenElseZero(inside, hn::Mul(color.x, w)), hn::IfThenElseZero(inside, hn::Mul(color.y, w)),
                     hn::IfThenElseZero(inside, hn::Mul(color.z, w))});
  }
  return {hn::GetLane(hn::SumOfLanes(d, sum.x)), hn::GetLane(hn::SumOfLanes(d, sum.y)), hn::GetLane(hn::SumOfLanes(d, sum.z))};
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
HWY_EXPORT(AppendSamples);
HWY_EXPORT(AppendVirtualLights);
HWY_EXPORT(WeightedSum);

void append_samples(const EyeSample& eye, std::uint32_t eye_index, const LightSampleBatch& lights, std::size_t first, std::size_t count,
                    std::uint32_t number, const SampleWeights& weights, Contributions& out) {
  HWY_DYNAMIC_DISPATCH(AppendSamples)(eye, eye_index, lights, first, count, number, weights, out);
}
void append_virtual_lights(const EyeSample& eye, std::uint32_t eye_index, const VirtualPointLights& lights, Contributions& out) {
  HWY_DYNAMIC_DISPATCH(AppendVirtualLights)(eye, eye_index, lights, out);
}
Color weighted_sum(const Contributions& contributions, const float* weights, std::size_t begin, std::size_t end) {
  return HWY_DYNAMIC_DISPATCH(WeightedSum)(contributions, weights, begin, end);
}

}  // namespace sightline
#endif
