// Evaluates SurfaceLobes towards as many directions as the target has lanes.
//
// Included once for each SIMD target, after hwy/foreach_target.h.
#if defined(SIGHTLINE_SHADE_SURFACE_LOBES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SIGHTLINE_SHADE_SURFACE_LOBES_INL_H_
#undef SIGHTLINE_SHADE_SURFACE_LOBES_INL_H_
#else
#define SIGHTLINE_SHADE_SURFACE_LOBES_INL_H_
#endif

#include <hwy/highway.h>

#include "base/simd/vec3-inl.h"
#include "shade/surface_lobes.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE::lanes {

/// f |cos| and density, as BsdfEval.
struct LobesEval {
  V3 f_cos;
  V pdf;
};

/// `cosine` in [0, 1]; eta >= 1, so there is no total reflection (fresnel_dielectric).
HWY_INLINE V fresnel_dielectric_lanes(D d, V cosine, float eta) {
  const V one = hn::Set(d, 1.f), n = hn::Set(d, eta);
  const V c = hn::Min(cosine, one);
  const V t = hn::Sqrt(hn::Max(hn::Zero(d), hn::Sub(one, hn::Mul(hn::Sub(one, hn::Mul(c, c)), hn::Set(d, 1 / (eta * eta))))));
  // Both denominators are zero only where c and t are; there all is reflected.
  const V tiny = hn::Set(d, 1e-20f);
  const V parallel_from = hn::MulAdd(n, c, t), across_from = hn::MulAdd(n, t, c);
  const V parallel = hn::Div(hn::MulSub(n, c, t), hn::Max(parallel_from, tiny));
  const V across = hn::Div(hn::NegMulAdd(n, t, c), hn::Max(across_from, tiny));
  const V reflected = hn::Mul(hn::Set(d, 0.5f), hn::MulAdd(parallel, parallel, hn::Mul(across, across)));
  return hn::IfThenElse(hn::And(hn::Gt(parallel_from, hn::Zero(d)), hn::Gt(across_from, hn::Zero(d))), reflected, one);
}

/// One channel of fresnel_conductor.
HWY_INLINE V fresnel_conductor_lanes(D d, V c, float eta, float k) {
  const V c2 = hn::Mul(c, c), s2 = hn::Sub(hn::Set(d, 1.f), c2), tiny = hn::Set(d, 1e-20f);
  const V t0 = hn::Sub(hn::Set(d, eta * eta - k * k), s2);
  const V a2_plus_b2 = hn::Sqrt(hn::MulAdd(t0, t0, hn::Set(d, 4 * eta * eta * k * k)));
  const V a = hn::Sqrt(hn::Max(hn::Mul(hn::Set(d, 0.5f), hn::Add(a2_plus_b2, t0)), hn::Zero(d)));
  const V sum = hn::Add(a2_plus_b2, c2), twice = hn::Mul(hn::Add(c, c), a);
  const V across = hn::Div(hn::Sub(sum, twice), hn::Max(hn::Add(sum, twice), tiny));
  const V sum_parallel = hn::MulAdd(c2, a2_plus_b2, hn::Mul(s2, s2)), twice_parallel = hn::Mul(twice, s2);
  const V parallel = hn::Mul(across, hn::Div(hn::Sub(sum_parallel, twice_parallel), hn::Max(hn::Add(sum_parallel, twice_parallel), tiny)));
  return hn::Min(hn::Max(hn::Mul(hn::Set(d, 0.5f), hn::Add(across, parallel)), hn::Zero(d)), hn::Set(d, 1.f));
}

/// Between the nodes of an albedo table: `low` is the node below.
HWY_INLINE V between_nodes(D d, const SurfaceLobes::Nodes& nodes, hn::Vec<DI> low, V fraction) {
  const V a = hn::GatherIndex(d, nodes.data(), low), b = hn::GatherIndex(d, nodes.data() + 1, low);
  return hn::MulAdd(fraction, hn::Sub(b, a), a);
}

/// What the interface lets through at `cosine` in [0, 1].
template <SurfaceLobes::Interface kInterface>
HWY_INLINE V3 transmittance(D d, const SurfaceLobes& s, V cosine) {
  constexpr int kLast = ggx_table::kCosCount - 1;
  const DI di;
  const V one = hn::Set(d, 1.f);
  const V place = hn::Mul(hn::Sqrt(hn::Min(cosine, one)), hn::Set(d, static_cast<float>(kLast)));
  const auto low = hn::Min(hn::ConvertTo(di, place), hn::Set(di, kLast - 1));
  const V fraction = hn::Sub(place, hn::ConvertTo(d, low));
  const V first = between_nodes(d, s.albedo, low, fraction);
  if constexpr (kInterface == SurfaceLobes::Interface::dielectric) {
    const V t = hn::NegMulAdd(first, fresnel_dielectric_lanes(d, cosine, s.eta.x), one);
    return {t, t, t};
  } else {
    const V rest = between_nodes(d, s.albedo_rest, low, fraction);
    const auto channel = [&](float f0) { return hn::Sub(one, hn::MulAdd(hn::Set(d, f0), first, hn::Mul(hn::Set(d, 1 - f0), rest))); };
    return {channel(s.f0.x), channel(s.f0.y), channel(s.f0.z)};
  }
}

/// tint F(cosine).
template <SurfaceLobes::Interface kInterface>
HWY_INLINE V3 tinted_fresnel(D d, const SurfaceLobes& s, V cosine) {
  if constexpr (kInterface == SurfaceLobes::Interface::dielectric) {
    return scale3(set3(d, s.tint), fresnel_dielectric_lanes(d, cosine, s.eta.x));
  } else if constexpr (kInterface == SurfaceLobes::Interface::conductor) {
    return mul3(set3(d, s.tint), {fresnel_conductor_lanes(d, cosine, s.eta.x, s.k.x), fresnel_conductor_lanes(d, cosine, s.eta.y, s.k.y),
                                  fresnel_conductor_lanes(d, cosine, s.eta.z, s.k.z)});
  } else {
    const V m = hn::Sub(hn::Set(d, 1.f), cosine), m2 = hn::Mul(m, m), weight = hn::Mul(hn::Mul(m2, m2), m);
    const auto channel = [&](float f0, float tint) {
      return hn::Mul(hn::Set(d, tint), hn::MulAdd(hn::Set(d, 1 - f0), weight, hn::Set(d, f0)));
    };
    return {channel(s.f0.x, s.tint.x), channel(s.f0.y, s.tint.y), channel(s.f0.z, s.tint.z)};
  }
}

/// Towards unit `wi`, local, z > 0; `kInterface` is s.interface. Lambert alone reads wi.z only.
template <SurfaceLobes::Interface kInterface>
HWY_INLINE LobesEval evaluate_lobes(D d, const SurfaceLobes& s, const V3& wi) {
  const V lambert = hn::Mul(wi.z, hn::Set(d, kInvPi));
  LobesEval e{scale3(set3(d, s.base), lambert), hn::Mul(lambert, hn::Set(d, s.lambert_share))};
  if constexpr (kInterface == SurfaceLobes::Interface::none) return e;
  if constexpr (kInterface == SurfaceLobes::Interface::dielectric || kInterface == SurfaceLobes::Interface::schlick)
    e.f_cos = mul3(e.f_cos, transmittance<kInterface>(d, s, wi.z));
  if (!s.has_ggx) return e;

  const Vec2 alpha = s.ggx.alpha();
  const auto stretch2 = [&](const V3& w, float ax2, float ay2) {
    return hn::MulAdd(hn::Mul(w.x, w.x), hn::Set(d, ax2), hn::MulAdd(hn::Mul(w.y, w.y), hn::Set(d, ay2), hn::Mul(w.z, w.z)));
  };
  const V3 wo = set3(d, s.wo), h = add3(wo, wi);
  const V squared = hn::Max(dot3(h, h), hn::Set(d, 1e-20f)), inverse = hn::Div(hn::Set(d, 1.f), hn::Sqrt(squared));
  const V cosine = hn::Min(hn::Max(hn::Mul(dot3(wo, h), inverse), hn::Zero(d)), hn::Set(d, 1.f));
  const V shape = hn::Mul(stretch2(h, 1 / (alpha.x * alpha.x), 1 / (alpha.y * alpha.y)), hn::Mul(inverse, inverse));
  const V half_distribution = hn::Div(hn::Set(d, 0.5f * kInvPi / (alpha.x * alpha.y)), hn::Mul(shape, shape));
  const V stretch_i = hn::Sqrt(stretch2(wi, alpha.x * alpha.x, alpha.y * alpha.y));
  const V shadowing = hn::Div(wi.z, hn::MulAdd(hn::Set(d, s.wo.z), stretch_i, hn::Mul(wi.z, hn::Set(d, s.ggx.stretch(s.wo)))));
  const V scale = hn::Mul(half_distribution, shadowing);
  const V3 fresnel = tinted_fresnel<kInterface>(d, s, cosine);
  e.f_cos = {hn::MulAdd(fresnel.x, scale, e.f_cos.x), hn::MulAdd(fresnel.y, scale, e.f_cos.y), hn::MulAdd(fresnel.z, scale, e.f_cos.z)};
  e.pdf = hn::MulAdd(half_distribution, hn::Set(d, s.ggx_share * s.ggx.masking_over_cosine(s.wo)), e.pdf);
  return e;
}

}  // namespace sightline::HWY_NAMESPACE::lanes
HWY_AFTER_NAMESPACE();

#endif  // SIGHTLINE_SHADE_SURFACE_LOBES_INL_H_
