#include "methods/visibility_cache/eye_lanes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "methods/visibility_cache/eye_lanes.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "base/simd/vec3-inl.h"
#include "shade/surface_lobes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

using namespace lanes;

using Interface = SurfaceLobes::Interface;

/// An eye point in all lanes, its tangents and normal in the lobes' frame.
struct EyeV {
  V3 tangent, bitangent, normal, geometric;
  float wo_normal, wo_geometric;
};

HWY_INLINE EyeV eye_of(D d, const EyeSample& eye) {
  return {set3(d, eye.frame.tangent),    set3(d, eye.frame.bitangent),       set3(d, eye.frame.normal),
          set3(d, eye.geometric_normal), glm::dot(eye.wo, eye.frame.normal), glm::dot(eye.wo, eye.geometric_normal)};
}

/// Reflection by the shading normal and by the geometric one.
HWY_INLINE M reflects(D d, const EyeV& eye, V cos_normal, V cos_geometric) {
  return hn::And(hn::Gt(hn::Mul(hn::Set(d, eye.wo_normal), cos_normal), hn::Zero(d)),
                 hn::Gt(hn::Mul(hn::Set(d, eye.wo_geometric), cos_geometric), hn::Zero(d)));
}

/// Towards unit `wi`, whose cosine with the shading normal is `cosine`.
template <Interface kInterface>
HWY_INLINE LobesEval evaluate_towards(D d, const EyeV& eye, const SurfaceLobes& lobes, const V3& wi, V cosine) {
  return evaluate_lobes<kInterface>(d, lobes, {dot3(wi, eye.tangent), dot3(wi, eye.bitangent), hn::Abs(cosine)});
}

HWY_INLINE void append(D d, const V3& value, M keep, std::uint32_t eye_index, hn::Vec<DU> light, Contributions& out) {
  keep = hn::And(keep, hn::Gt(max3(value), hn::Zero(d)));
  if (hn::AllFalse(d, keep)) return;
  const DU du;
  compress_store3(d, value, keep, out.color, out.size);
  hn::StoreU(hn::Set(du, eye_index), du, out.eye.data() + out.size);
  out.size += compress_store(light, hn::RebindMask(du, keep), du, out.light.data() + out.size);
}

template <Interface kInterface>
void append_samples_to(const EyeSample& sample, const SurfaceLobes& lobes, std::uint32_t eye_index, const LightSampleBatch& lights,
                       std::size_t first, std::size_t count, std::uint32_t number, const SampleWeights& weights, Contributions& out) {
  const D d;
  const DU du;
  const EyeV eye = eye_of(d, sample);
  const V3 throughput = set3(d, sample.weight);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const V3 wi = load3(d, lights.wi, first + i);
    const V pdf = hn::LoadU(d, lights.pdf.data() + first + i);
    const V cosine = dot3(wi, eye.normal);
    M keep = hn::And(hn::FirstN(d, count - i), hn::Gt(pdf, hn::Zero(d)));
    keep = hn::And(keep, reflects(d, eye, cosine, dot3(wi, eye.geometric)));
    if (hn::AllFalse(d, keep)) continue;
    const LobesEval eval = evaluate_towards<kInterface>(d, eye, lobes, wi, cosine);
    V scale = hn::Div(hn::Set(d, weights.scale), pdf);
    if (weights.mis_bsdf > 0) {
      const V own = hn::Mul(pdf, hn::Set(d, weights.mis_light));
      scale = hn::Mul(scale, hn::Div(own, hn::MulAdd(eval.pdf, hn::Set(d, weights.mis_bsdf), own)));
    }
    const V3 value = scale3(mul3(mul3(load3(d, lights.radiance, first + i), throughput), eval.f_cos), scale);
    append(d, value, keep, eye_index, hn::Add(hn::Iota(du, number), hn::Set(du, static_cast<std::uint32_t>(i))), out);
  }
}

/// What points of surfaces bring that send `radiance` from `position` with unit `normal`. `cos_sent` > 0 is demanded of `kOneSided` ones.
template <Interface kInterface, bool kOneSided>
HWY_INLINE void append_senders(D d, const EyeSample& sample, const EyeV& eye, const SurfaceLobes& lobes, const V3& position,
                               const V3& normal, const V3& radiance, float max_geometry_term, M keep, std::uint32_t eye_index,
                               hn::Vec<DU> light, Contributions& out) {
  const V zero = hn::Zero(d);
  const V3 to = sub3(position, set3(d, sample.position));
  const V squared = dot3(to, to);
  const V3 wi = scale3(to, hn::Div(hn::Set(d, 1.f), hn::Sqrt(squared)));
  const V cosine = dot3(wi, eye.normal);
  V cos_sent = hn::Neg(dot3(wi, normal));
  if constexpr (!kOneSided) cos_sent = hn::Abs(cos_sent);
  keep = hn::And(keep, hn::And(hn::Gt(cos_sent, zero), hn::Gt(squared, zero)));
  keep = hn::And(keep, reflects(d, eye, cosine, dot3(wi, eye.geometric)));
  if (hn::AllFalse(d, keep)) return;
  // f_cos holds the eye's cosine; the geometry term with both is clamped.
  const LobesEval eval = evaluate_towards<kInterface>(d, eye, lobes, wi, cosine);
  const V geometry = hn::Min(hn::Div(cos_sent, squared), hn::Div(hn::Set(d, max_geometry_term), hn::Abs(cosine)));
  append(d, scale3(mul3(mul3(radiance, set3(d, sample.weight)), eval.f_cos), geometry), keep, eye_index, light, out);
}

template <Interface kInterface>
void append_virtual_lights_to(const EyeSample& sample, const SurfaceLobes& lobes, std::uint32_t eye_index, const VirtualPointLights& lights,
                              Contributions& out) {
  const D d;
  const DU du;
  const hn::Rebind<std::uint8_t, D> bytes;
  const EyeV eye = eye_of(d, sample);
  for (std::size_t i = 0; i < lights.size; i += hn::Lanes(d)) {
    const M lambert = hn::RebindMask(d, hn::Ne(hn::PromoteTo(du, hn::LoadU(bytes, lights.lambert.data() + i)), hn::Zero(du)));
    append_senders<kInterface, true>(d, sample, eye, lobes, load3(d, lights.position, i), load3(d, lights.normal, i),
                                     load3(d, lights.radiosity, i), lights.max_geometry_term,
                                     hn::And(lambert, hn::FirstN(d, lights.size - i)), eye_index,
                                     hn::Add(hn::Iota(du, 0u), hn::Set(du, static_cast<std::uint32_t>(i))), out);
  }
}

template <Interface kInterface>
void append_unit_lights_to(const EyeSample& sample, const SurfaceLobes& lobes, std::uint32_t eye_index, const VirtualPointLights& lights,
                           std::span<const std::uint32_t> which, Contributions& out) {
  const D d;
  const DU du;
  const DI di;
  const EyeV eye = eye_of(d, sample);
  const V one = hn::Set(d, 1.f);
  for (std::size_t i = 0; i < which.size(); i += hn::Lanes(d)) {
    std::array<std::uint32_t, kLanes> indices{};
    std::copy_n(which.data() + i, std::min(hn::Lanes(d), which.size() - i), indices.data());
    const auto from = hn::BitCast(di, hn::LoadU(du, indices.data()));
    append_senders<kInterface, false>(d, sample, eye, lobes, gather3(d, lights.position, from), gather3(d, lights.normal, from),
                                      {one, one, one}, lights.max_geometry_term, hn::FirstN(d, which.size() - i), eye_index,
                                      hn::Add(hn::Iota(du, 0u), hn::Set(du, static_cast<std::uint32_t>(i))), out);
  }
}

/// Calls `append` with the interface as a constant.
template <class Append>
void with_interface(const SurfaceLobes& lobes, const Append& append) {
  switch (lobes.interface) {
    case Interface::none:
      return append(std::integral_constant<Interface, Interface::none>());
    case Interface::dielectric:
      return append(std::integral_constant<Interface, Interface::dielectric>());
    case Interface::conductor:
      return append(std::integral_constant<Interface, Interface::conductor>());
    case Interface::schlick:
      return append(std::integral_constant<Interface, Interface::schlick>());
  }
}

void AppendSamples(const EyeSample& eye, const SurfaceLobes& lobes, std::uint32_t eye_index, const LightSampleBatch& lights,
                   std::size_t first, std::size_t count, std::uint32_t number, const SampleWeights& weights, Contributions& out) {
  with_interface(
      lobes, [&](auto interface) { append_samples_to<interface()>(eye, lobes, eye_index, lights, first, count, number, weights, out); });
}

void AppendVirtualLights(const EyeSample& eye, const SurfaceLobes& lobes, std::uint32_t eye_index, const VirtualPointLights& lights,
                         Contributions& out) {
  with_interface(lobes, [&](auto interface) { append_virtual_lights_to<interface()>(eye, lobes, eye_index, lights, out); });
}

void AppendUnitLights(const EyeSample& eye, const SurfaceLobes& lobes, std::uint32_t eye_index, const VirtualPointLights& lights,
                      std::span<const std::uint32_t> which, Contributions& out) {
  with_interface(lobes, [&](auto interface) { append_unit_lights_to<interface()>(eye, lobes, eye_index, lights, which, out); });
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
HWY_EXPORT(AppendUnitLights);
HWY_EXPORT(WeightedSum);

void append_samples(const EyeSample& eye, const SurfaceLobes& lobes, std::uint32_t eye_index, const LightSampleBatch& lights,
                    std::size_t first, std::size_t count, std::uint32_t number, const SampleWeights& weights, Contributions& out) {
  HWY_DYNAMIC_DISPATCH(AppendSamples)(eye, lobes, eye_index, lights, first, count, number, weights, out);
}
void append_virtual_lights(const EyeSample& eye, const SurfaceLobes& lobes, std::uint32_t eye_index, const VirtualPointLights& lights,
                           Contributions& out) {
  HWY_DYNAMIC_DISPATCH(AppendVirtualLights)(eye, lobes, eye_index, lights, out);
}
void append_unit_lights(const EyeSample& eye, const SurfaceLobes& lobes, std::uint32_t eye_index, const VirtualPointLights& lights,
                        std::span<const std::uint32_t> which, Contributions& out) {
  HWY_DYNAMIC_DISPATCH(AppendUnitLights)(eye, lobes, eye_index, lights, which, out);
}
Color weighted_sum(const Contributions& contributions, const float* weights, std::size_t begin, std::size_t end) {
  return HWY_DYNAMIC_DISPATCH(WeightedSum)(contributions, weights, begin, end);
}

}  // namespace sightline
#endif
