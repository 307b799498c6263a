#include "methods/lambert_lanes.h"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "methods/lambert_lanes.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include <hwy/contrib/math/math-inl.h>

#include "base/simd/vec3-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

using namespace lanes;

// Fused, unlike dot3.
HWY_INLINE V fused_dot3(const V3& a, const V3& b) { return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z))); }
HWY_INLINE V3 fused_scale_add3(const V3& a, V s, const V3& b) {
  return {hn::MulAdd(a.x, s, b.x), hn::MulAdd(a.y, s, b.y), hn::MulAdd(a.z, s, b.z)};
}
HWY_INLINE V l1(const V3& n) { return hn::Add(hn::Abs(n.x), hn::Add(hn::Abs(n.y), hn::Abs(n.z))); }

/// What the direct light of a lane needs of its shading point.
struct PointV {
  V3 wo, ng, ns, albedo, position, throughput;
  V error;
};

// A shading normal that faces away from the viewer gives way to the geometric one.
HWY_INLINE V3 usable_normal(D d, const V3& wo, const V3& ns, const V3& ng) {
  return select3(hn::Gt(hn::Mul(fused_dot3(wo, ns), fused_dot3(wo, ng)), hn::Zero(d)), ns, ng);
}

// Moves p off the surface with normal n towards the side of w (offset_origin of world/surface.h).
HWY_INLINE V3 offset_along(const V3& p, const V3& n, V error, V side) {
  return fused_scale_add3(n, hn::CopySign(hn::Mul(error, l1(n)), side), p);
}

HWY_INLINE void emit(D d, const PointV& p, hn::Vec<DU> point, const LightSampleBatch& light, std::size_t lane, M valid,
                     const DirectLightOptions& options, ShadowLanes& out) {
  const DU du;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.f);
  const V3 wi = load3(d, light.wi, lane);
  const V pdf = hn::LoadU(d, light.pdf.data() + lane);
  const V cos_i = fused_dot3(wi, p.ns), side = fused_dot3(wi, p.ng);

  // Reflection by both normals, and a light sample that reaches the point at all.
  M keep = hn::And(valid, hn::Gt(pdf, zero));
  keep = hn::And(keep, hn::Gt(hn::Mul(fused_dot3(p.wo, p.ns), cos_i), zero));
  keep = hn::And(keep, hn::Gt(hn::Mul(fused_dot3(p.wo, p.ng), side), zero));
  if (!out.in_place && hn::AllFalse(d, keep)) return;

  const V abs_cos = hn::Abs(cos_i);
  const V bsdf_pdf = hn::Mul(abs_cos, hn::Set(d, kInvPi));
  V scale = hn::Div(bsdf_pdf, hn::Mul(pdf, hn::Set(d, options.samples)));
  const V distance = hn::LoadU(d, light.distance.data() + lane);
  const M infinite = hn::Eq(distance, hn::Set(d, std::numeric_limits<float>::infinity()));
  if (options.mis) {
    // Rays find emissive geometry and the environment; other lights keep weight 1.
    const auto bytes = hn::Rebind<std::uint8_t, D>();
    const auto flags = [&](const std::uint8_t* data) {
      return hn::Ne(hn::BitCast(d, hn::PromoteTo(du, hn::LoadU(bytes, data + lane))), zero);
    };
    const M is_mesh = flags(light.is_mesh.data()), is_delta = flags(light.is_delta.data());
    const M other = hn::AndNot(is_delta, hn::Or(is_mesh, infinite));
    const V a = hn::Mul(hn::Set(d, options.samples), pdf);
    const V a2 = hn::Mul(a, a);
    const V weight = hn::Div(a2, hn::MulAdd(bsdf_pdf, bsdf_pdf, a2));
    scale = hn::IfThenElse(other, hn::Mul(scale, weight), scale);
  }
  const V3 radiance = load3(d, light.radiance, lane);
  const V3 value = {hn::Mul(hn::Mul(hn::Mul(p.albedo.x, p.throughput.x), radiance.x), scale),
                    hn::Mul(hn::Mul(hn::Mul(p.albedo.y, p.throughput.y), radiance.y), scale),
                    hn::Mul(hn::Mul(hn::Mul(p.albedo.z, p.throughput.z), radiance.z), scale)};
  keep = hn::And(keep, hn::Gt(max3(value), zero));
  if (!out.in_place && hn::AllFalse(d, keep)) return;

  const V3 origin = offset_along(p.position, p.ng, p.error, side);
  const V3 light_normal = load3(d, light.normal, lane);
  const V3 target = offset_along(load3(d, light.point, lane), light_normal, hn::LoadU(d, light.point_error.data() + lane),
                                 hn::Neg(fused_dot3(wi, light_normal)));
  const V3 direction = select3(infinite, wi, sub3(target, origin));
  const V t_far = hn::IfThenElse(infinite, distance, one);

  const std::size_t at = out.count;
  if (out.in_place) {
    const auto put = [&](V v, AlignedVector<float>& array) { hn::StoreU(v, d, array.data() + at); };
    const auto put_kept = [&](V v, AlignedVector<float>& array) { put(hn::IfThenElseZero(keep, v), array); };
    put(origin.x, out.rays.origin.x), put(origin.y, out.rays.origin.y), put(origin.z, out.rays.origin.z);
    put(direction.x, out.rays.direction.x), put(direction.y, out.rays.direction.y), put(direction.z, out.rays.direction.z);
    put(zero, out.rays.t_near), put(hn::IfThenElse(keep, t_far, hn::Set(d, -1.f)), out.rays.t_far);
    put_kept(value.x, out.contribution.x), put_kept(value.y, out.contribution.y), put_kept(value.z, out.contribution.z);
    hn::StoreU(point, du, out.point.data() + at);
    out.count += hn::Lanes(d);
    return;
  }
  const auto put = [&](V v, AlignedVector<float>& array) { compress_store(v, keep, d, array.data() + at); };
  put(origin.x, out.rays.origin.x), put(origin.y, out.rays.origin.y), put(origin.z, out.rays.origin.z);
  put(direction.x, out.rays.direction.x), put(direction.y, out.rays.direction.y), put(direction.z, out.rays.direction.z);
  put(zero, out.rays.t_near), put(t_far, out.rays.t_far);
  put(value.x, out.contribution.x), put(value.y, out.contribution.y), put(value.z, out.contribution.z);
  out.count += compress_store(point, hn::RebindMask(du, keep), du, out.point.data() + at);
}

void AppendDirectLight(const ShadingPoints& points, std::uint32_t point, const LightSampleBatch& light, std::size_t first,
                       std::size_t count, const DirectLightOptions& options, ShadowLanes& out) {
  const D d;
  const DU du;
  const SurfaceBatch& s = *points.surfaces;
  PointV p;
  p.wo = neg3(set3(d, points.rays->direction, point));
  p.ng = set3(d, s.geometric_normal, point);
  p.ns = usable_normal(d, p.wo, set3(d, s.shading_normal, point), p.ng);
  p.albedo = set3(d, s.albedo, point);
  p.position = set3(d, s.position, point);
  p.throughput = set3(d, *points.throughput, point);
  p.error = hn::Set(d, s.error[point]);
  // In place, a run fills whole groups of kLanes.
  const std::size_t lanes = out.in_place ? padded(count) : count;
  for (std::size_t i = 0; i < lanes; i += hn::Lanes(d))
    emit(d, p, hn::Set(du, point), light, first + std::min(i, count), hn::FirstN(d, count - std::min(i, count)), options, out);
}

void AppendDirectLightEach(const ShadingPoints& points, std::uint32_t first_point, const LightSampleBatch& light, std::size_t count,
                           const std::uint8_t* active, const DirectLightOptions& options, ShadowLanes& out) {
  const D d;
  const DU du;
  const auto bytes = hn::Rebind<std::uint8_t, D>();
  const SurfaceBatch& s = *points.surfaces;
  const std::size_t lanes = out.in_place ? padded(count) : count;
  for (std::size_t i = 0; i < lanes; i += hn::Lanes(d)) {
    const std::size_t at = first_point + i;
    const auto flag = hn::PromoteTo(du, hn::LoadU(bytes, active + at));
    const M valid = hn::And(hn::FirstN(d, count - std::min(i, count)), hn::RebindMask(d, hn::Ne(flag, hn::Zero(du))));
    if (!out.in_place && hn::AllFalse(d, valid)) continue;
    PointV p;
    p.wo = neg3(load3(d, points.rays->direction, at));
    p.ng = load3(d, s.geometric_normal, at);
    p.ns = usable_normal(d, p.wo, load3(d, s.shading_normal, at), p.ng);
    p.albedo = load3(d, s.albedo, at);
    p.position = load3(d, s.position, at);
    p.throughput = load3(d, *points.throughput, at);
    p.error = hn::LoadU(d, s.error.data() + at);
    emit(d, p, hn::Add(hn::Iota(du, static_cast<std::uint32_t>(at)), hn::Zero(du)), light, i, valid, options, out);
  }
}

void AddVisible(const ShadowLanes& lanes, const std::uint8_t* HWY_RESTRICT occluded, std::size_t count, Vec3Batch& radiance) {
  const D d;
  const DU du;
  const auto bytes = hn::Rebind<std::uint8_t, D>();
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const M visible = hn::RebindMask(d, hn::Eq(hn::PromoteTo(du, hn::LoadU(bytes, occluded + i)), hn::Zero(du)));
    const V3 sum = load3(d, radiance, i), more = load3(d, lanes.contribution, i);
    hn::StoreU(hn::Add(sum.x, hn::IfThenElseZero(visible, more.x)), d, radiance.x.data() + i);
    hn::StoreU(hn::Add(sum.y, hn::IfThenElseZero(visible, more.y)), d, radiance.y.data() + i);
    hn::StoreU(hn::Add(sum.z, hn::IfThenElseZero(visible, more.z)), d, radiance.z.data() + i);
  }
}

void SampleLambert(const ShadingPoints& points, const float* HWY_RESTRICT u, const float* HWY_RESTRICT v, std::size_t count, Vec3Batch& wi,
                   float* HWY_RESTRICT pdf) {
  const D d;
  const SurfaceBatch& s = *points.surfaces;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.f);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const V3 wo = neg3(load3(d, points.rays->direction, i));
    const V3 ng = load3(d, s.geometric_normal, i);
    V3 n = usable_normal(d, wo, load3(d, s.shading_normal, i), ng);
    // The hemisphere on the viewer's side: two-sided Lambert.
    const V cos_o = fused_dot3(wo, n);
    const V flip = hn::CopySign(one, cos_o);
    n = {hn::Mul(n.x, flip), hn::Mul(n.y, flip), hn::Mul(n.z, flip)};

    // Concentric disk [Shirley1997], lifted to the hemisphere.
    const V a = hn::MulSub(hn::Set(d, 2.f), hn::LoadU(d, u + i), one), b = hn::MulSub(hn::Set(d, 2.f), hn::LoadU(d, v + i), one);
    const M wide = hn::Gt(hn::Abs(a), hn::Abs(b));
    const V radius = hn::IfThenElse(wide, a, b), other = hn::IfThenElse(wide, b, a);
    const V ratio = hn::IfThenElse(hn::Eq(radius, zero), zero, hn::Div(other, radius));
    const V angle = hn::Mul(ratio, hn::Set(d, kPi / 4));
    const V c = hn::Cos(d, angle), si = hn::Sin(d, angle);
    const V x = hn::Mul(radius, hn::IfThenElse(wide, c, si)), y = hn::Mul(radius, hn::IfThenElse(wide, si, c));
    const V z = hn::Sqrt(hn::Max(zero, hn::Sub(one, hn::MulAdd(x, x, hn::Mul(y, y)))));

    // Branchless frame about n [Duff2017].
    const V sign = hn::CopySign(one, n.z);
    const V f = hn::Neg(hn::Div(one, hn::Add(sign, n.z)));
    const V g = hn::Mul(hn::Mul(n.x, n.y), f);
    const V3 t = {hn::MulAdd(hn::Mul(sign, hn::Mul(n.x, n.x)), f, one), hn::Mul(sign, g), hn::Neg(hn::Mul(sign, n.x))};
    const V3 w = {g, hn::MulAdd(hn::Mul(n.y, n.y), f, sign), hn::Neg(n.y)};
    const V3 out = {hn::MulAdd(t.x, x, hn::MulAdd(w.x, y, hn::Mul(n.x, z))), hn::MulAdd(t.y, x, hn::MulAdd(w.y, y, hn::Mul(n.y, z))),
                    hn::MulAdd(t.z, x, hn::MulAdd(w.z, y, hn::Mul(n.z, z)))};
    const M same_side = hn::Gt(hn::Mul(fused_dot3(out, ng), fused_dot3(wo, ng)), zero);
    hn::StoreU(out.x, d, wi.x.data() + i), hn::StoreU(out.y, d, wi.y.data() + i), hn::StoreU(out.z, d, wi.z.data() + i);
    hn::StoreU(hn::IfThenElseZero(same_side, hn::Mul(z, hn::Set(d, kInvPi))), d, pdf + i);
  }
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
HWY_EXPORT(AppendDirectLight);
HWY_EXPORT(AppendDirectLightEach);
HWY_EXPORT(AddVisible);
HWY_EXPORT(SampleLambert);

void ShadowLanes::resize(std::size_t capacity) {
  // compress_store() writes a whole vector at the last element.
  const std::size_t size = capacity + 2 * kLanes;
  rays.resize(size);
  contribution.resize(size);
  point.resize(padded(size));
  count = 0;
}

void append_direct_light(const ShadingPoints& points, std::uint32_t point, const LightSampleBatch& light, std::size_t first,
                         std::size_t count, const DirectLightOptions& options, ShadowLanes& out) {
  HWY_DYNAMIC_DISPATCH(AppendDirectLight)(points, point, light, first, count, options, out);
}
void append_direct_light_each(const ShadingPoints& points, std::uint32_t first_point, const LightSampleBatch& light, std::size_t count,
                              const std::uint8_t* active, const DirectLightOptions& options, ShadowLanes& out) {
  HWY_DYNAMIC_DISPATCH(AppendDirectLightEach)(points, first_point, light, count, active, options, out);
}
void add_visible(const ShadowLanes& lanes, const std::uint8_t* occluded, std::size_t count, Vec3Batch& radiance) {
  HWY_DYNAMIC_DISPATCH(AddVisible)(lanes, occluded, count, radiance);
}
void sample_lambert(const ShadingPoints& points, const float* u, const float* v, std::size_t count, Vec3Batch& wi, float* pdf) {
  HWY_DYNAMIC_DISPATCH(SampleLambert)(points, u, v, count, wi, pdf);
}

}  // namespace sightline
#endif
