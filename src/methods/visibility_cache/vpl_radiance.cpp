#include "methods/visibility_cache/vpl_radiance.h"

#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "methods/visibility_cache/vpl_radiance.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "base/math/vec3_batch.h"
#include "base/simd/vec3-inl.h"
#include "shade/surface_lobes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

using namespace lanes;
using Interface = SurfaceLobes::Interface;

/// Light `j`, whose BSDF has lobes seen from where its light came from: BSDFs of that shape are reciprocal.
template <Interface kInterface>
void send_lobes(const VirtualPointLights& lights, std::uint32_t j, const Vec3Batch& points, std::size_t count, std::size_t first,
                Vec3Batch& out) {
  const D d;
  const SurfaceLobes& lobes = *lights.lobes[j];
  const Frame3& frame = lights.frame[j];
  const Vec3 wi = lights.wi[j], side = load(lights.normal, j);
  const Vec3 geometric = glm::dot(side, frame.normal) < 0 ? -side : side;
  const float in_shading = glm::dot(wi, frame.normal), in_geometric = glm::dot(wi, geometric);
  // evaluate_lobes holds the cosine of the wrong direction.
  const Color scale = load(lights.flux, j) * (std::fabs(in_shading) / glm::dot(side, wi));
  const V zero = hn::Zero(d);
  for (std::size_t k = 0; k < count; k += hn::Lanes(d)) {
    const V3 to = sub3(load3(d, points, k), set3(d, load(lights.position, j)));
    const V3 wo = scale3(to, hn::Div(hn::Set(d, 1.f), hn::Sqrt(dot3(to, to))));
    const V out_shading = dot3(wo, set3(d, frame.normal)), out_geometric = dot3(wo, set3(d, geometric));
    const M reflects =
        hn::And(hn::Gt(hn::Mul(out_shading, hn::Set(d, in_shading)), zero), hn::Gt(hn::Mul(out_geometric, hn::Set(d, in_geometric)), zero));
    const V cosine = hn::Abs(out_shading);
    const V3 local = {dot3(wo, set3(d, frame.tangent)), dot3(wo, set3(d, frame.bitangent)), cosine};
    const V3 value = mul3(scale3(evaluate_lobes<kInterface>(d, lobes, local).f_cos, hn::Div(hn::Set(d, 1.f), cosine)), set3(d, scale));
    store3(d, {hn::IfThenElseZero(reflects, value.x), hn::IfThenElseZero(reflects, value.y), hn::IfThenElseZero(reflects, value.z)}, out,
           first + k);
    // Where shading and geometric normal disagree about the direction, the light shows another frame.
    const M turned = hn::Not(hn::Gt(hn::Mul(out_shading, out_geometric), zero));
    if (hn::AllFalse(d, hn::And(turned, hn::FirstN(d, count - k)))) continue;
    for (std::size_t i = k; i < std::min(count, k + hn::Lanes(d)); ++i) {
      const Vec3 w = glm::normalize(load(points, i) - load(lights.position, j));
      if (!(glm::dot(w, frame.normal) * glm::dot(w, geometric) > 0)) store(out, first + i, radiance_towards(lights, j, w));
    }
  }
}

void SendLobes(const VirtualPointLights& lights, std::uint32_t j, const Vec3Batch& points, std::size_t count, std::size_t first,
               Vec3Batch& out) {
  switch (lights.lobes[j]->interface) {
    case Interface::none:
      return send_lobes<Interface::none>(lights, j, points, count, first, out);
    case Interface::dielectric:
      return send_lobes<Interface::dielectric>(lights, j, points, count, first, out);
    case Interface::conductor:
      return send_lobes<Interface::conductor>(lights, j, points, count, first, out);
    case Interface::schlick:
      return send_lobes<Interface::schlick>(lights, j, points, count, first, out);
  }
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
HWY_EXPORT(SendLobes);

void send_radiance(const VirtualPointLights& lights, std::span<const std::uint32_t> which, const Vec3Batch& points, std::size_t count,
                   SentRadiance& sent) {
  sent.stride = padded(count);
  sent.radiance.resize(sent.stride * which.size());
  for (std::size_t i = 0; i < which.size(); ++i) {
    const std::uint32_t j = which[i];
    const std::size_t first = i * sent.stride;
    if (lights.lobes[j]) {
      HWY_DYNAMIC_DISPATCH(SendLobes)(lights, j, points, count, first, sent.radiance);
      continue;
    }
    for (std::size_t k = 0; k < count; ++k) {
      const Vec3 w = glm::normalize(load(points, k) - load(lights.position, j));
      store(sent.radiance, first + k, radiance_towards(lights, j, w));
    }
  }
}

}  // namespace sightline
#endif
