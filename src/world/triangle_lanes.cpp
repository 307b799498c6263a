#include "world/triangle_lanes.h"

#include "world/surface_records.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "world/triangle_lanes.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "base/simd/vec3-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

using namespace lanes;

HWY_INLINE V3 load3(D d, const float (*axes)[kLanes], std::size_t i) {
  return {hn::Load(d, axes[0] + i), hn::Load(d, axes[1] + i), hn::Load(d, axes[2] + i)};
}
HWY_INLINE V max_abs(const V3& a) { return hn::Max(hn::Abs(a.x), hn::Max(hn::Abs(a.y), hn::Abs(a.z))); }
HWY_INLINE void blend_store3(D d, M m, const V3& v, Vec3Batch& batch, std::size_t i) {
  hn::BlendedStore(v.x, m, d, batch.x.data() + i), hn::BlendedStore(v.y, m, d, batch.y.data() + i);
  hn::BlendedStore(v.z, m, d, batch.z.data() + i);
}
HWY_INLINE M in_range(D d, V length2) { return hn::And(hn::Gt(length2, hn::Set(d, 1e-30f)), hn::Lt(length2, hn::Set(d, 1e30f))); }

HWY_INLINE M mask_of(D d, std::uint16_t bits, std::size_t i) {
  const DU du;
  const auto lane = hn::Iota(du, static_cast<std::uint32_t>(i));
  const auto bit = hn::Shl(hn::Set(du, 1u), lane);
  return hn::RebindMask(d, hn::Ne(hn::And(hn::Set(du, bits), bit), hn::Zero(du)));
}

// Lanes outside the mask take the first vertex' data: any address that can be read.
void GatherLanes(const InstanceRecord& record, const std::uint32_t* HWY_RESTRICT primitives, std::uint16_t mask, TriangleLanes& lanes) {
  const D d;
  const DI di;
  const auto three = hn::Set(di, 3);
  const auto* indices = reinterpret_cast<const std::int32_t*>(record.triangles);
  const auto* positions = reinterpret_cast<const float*>(record.positions);
  const auto* normals = reinterpret_cast<const float*>(record.normals);
  for (std::size_t i = 0; i < kLanes; i += hn::Lanes(d)) {
    const M active = mask_of(d, mask, i);
    if (hn::AllFalse(d, active)) continue;
    const auto primitive = hn::LoadU(di, reinterpret_cast<const std::int32_t*>(primitives) + i);
    const auto triangle = hn::Mul(hn::IfThenElseZero(hn::RebindMask(di, active), primitive), three);
    for (int corner = 0; corner < 3; ++corner) {
      const auto vertex = hn::Mul(hn::GatherIndex(di, indices + corner, triangle), three);
      for (int axis = 0; axis < 3; ++axis) {
        hn::BlendedStore(hn::GatherIndex(d, positions + axis, vertex), active, d, lanes.p[corner][axis] + i);
        if (normals) hn::BlendedStore(hn::GatherIndex(d, normals + axis, vertex), active, d, lanes.n[corner][axis] + i);
      }
    }
    hn::BlendedStore(hn::Set(d, record.winding), active, d, lanes.winding + i);
  }
  lanes.active = static_cast<std::uint16_t>(lanes.active | mask);
  if (normals) lanes.smooth = static_cast<std::uint16_t>(lanes.smooth | mask);
}

void SetMaterialLanes(const MaterialRecord& material, std::uint16_t mask, std::size_t begin, SurfaceBatch& surfaces) {
  const D d;
  const DU du;
  for (std::size_t i = 0; i < kLanes; i += hn::Lanes(d)) {
    const M active = mask_of(d, mask, i);
    const auto active_u = hn::RebindMask(du, active);
    hn::BlendedStore(hn::Set(du, material.material), active_u, du, surfaces.material.data() + begin + i);
    hn::BlendedStore(hn::Set(du, kNoLight), active_u, du, surfaces.light.data() + begin + i);
    blend_store3(d, active, set3(d, material.albedo), surfaces.albedo, begin + i);
  }
  for (std::size_t i = 0; i < kLanes; ++i) {
    std::uint8_t& plain = surfaces.plain[begin + i];
    plain = (mask >> i) & 1 ? material.plain : plain;
  }
}

// Hits so close to an edge that inside_by may move them: rare, and left to the scalar definition. Squares avoid the roots; the slack makes
// up for their rounding.
HWY_INLINE M near_an_edge(D d, V margin, V u, V v, const V3& edge1, const V3& edge2, V area2) {
  const V3 edge3 = sub3(edge2, edge1);
  const V margin2 = hn::Mul(hn::Mul(margin, margin), hn::Set(d, 1.001f));
  const V w = hn::Sub(hn::Sub(hn::Set(d, 1.f), u), v);
  const auto close = [&](V b, const V3& edge) {
    return hn::Or(hn::Lt(b, hn::Zero(d)), hn::Lt(hn::Mul(hn::Mul(b, b), area2), hn::Mul(margin2, dot3(edge, edge))));
  };
  return hn::Or(close(u, edge2), hn::Or(close(v, edge1), close(w, edge3)));
}

// The same operations in the same order as reconstruct_triangle, so that both give the same bits.
std::uint16_t ReconstructLanes(const TriangleLanes& lanes, const float* HWY_RESTRICT u, const float* HWY_RESTRICT v, std::size_t begin,
                               SurfaceBatch& surfaces) {
  const D d;
  std::uint16_t left = 0;
  for (std::size_t i = 0; i < kLanes; i += hn::Lanes(d)) {
    const M active = mask_of(d, lanes.active, i);
    if (hn::AllFalse(d, active)) continue;
    const V bu = hn::Load(d, u + begin + i), bv = hn::Load(d, v + begin + i), one = hn::Set(d, 1.f);
    const V3 p0 = load3(d, lanes.p[0], i);
    const V3 edge1 = sub3(load3(d, lanes.p[1], i), p0), edge2 = sub3(load3(d, lanes.p[2], i), p0);
    const V3 position = add3(p0, add3(scale3(edge1, bu), scale3(edge2, bv)));
    const V size = hn::Max(max_abs(edge1), max_abs(edge2));
    const V error = hn::Mul(hn::Set(d, kRounding),
                            hn::Add(hn::Mul(hn::Set(d, kPointRoundings), max_abs(position)), hn::Mul(hn::Set(d, kEdgeRoundings), size)));
    const V3 n = cross3(edge1, edge2);
    const V length2 = dot3(n, n);
    const M usable = hn::And(active, in_range(d, length2));
    const M near_edge = near_an_edge(d, hn::Mul(hn::Set(d, kEdgeMargin), error), bu, bv, edge1, edge2, length2);
    const M usable_far = hn::AndNot(near_edge, usable);
    const V3 geometric = scale3(scale3(n, hn::Div(one, hn::Sqrt(length2))), hn::Load(d, lanes.winding + i));

    V3 shading = geometric;
    const M smooth = hn::And(usable, mask_of(d, lanes.smooth, i));
    if (!hn::AllFalse(d, smooth)) {
      const V bw = hn::Sub(hn::Sub(one, bu), bv);
      const V3 m =
          add3(add3(scale3(load3(d, lanes.n[0], i), bw), scale3(load3(d, lanes.n[1], i), bu)), scale3(load3(d, lanes.n[2], i), bv));
      const V m2 = dot3(m, m);
      const V side = hn::IfThenElse(hn::Lt(dot3(m, geometric), hn::Zero(d)), hn::Set(d, -1.f), one);
      const V3 unit = scale3(m, hn::Div(side, hn::Sqrt(m2)));
      const M good = hn::And(smooth, in_range(d, m2));
      shading = select3(good, unit, shading);
    }
    blend_store3(d, usable_far, position, surfaces.position, begin + i);
    blend_store3(d, usable_far, geometric, surfaces.geometric_normal, begin + i);
    blend_store3(d, usable_far, shading, surfaces.shading_normal, begin + i);
    hn::BlendedStore(error, usable_far, d, surfaces.error.data() + begin + i);

    alignas(kCacheLine) std::uint8_t bits[8] = {};
    const std::size_t bytes = hn::StoreMaskBits(d, hn::AndNot(usable_far, active), bits);
    for (std::size_t b = 0; b < bytes; ++b) left = static_cast<std::uint16_t>(left | (bits[b] << (i + 8 * b)));
  }
  return left;
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
HWY_EXPORT(GatherLanes);
HWY_EXPORT(ReconstructLanes);
HWY_EXPORT(SetMaterialLanes);

void gather_lanes(const InstanceRecord& record, const std::uint32_t* primitives, std::uint16_t mask, TriangleLanes& lanes) {
  HWY_DYNAMIC_DISPATCH(GatherLanes)(record, primitives, mask, lanes);
}

void set_material_lanes(const MaterialRecord& material, std::uint16_t mask, std::size_t begin, SurfaceBatch& surfaces) {
  HWY_DYNAMIC_DISPATCH(SetMaterialLanes)(material, mask, begin, surfaces);
}

std::uint16_t reconstruct_lanes(const TriangleLanes& lanes, const float* u, const float* v, std::size_t begin, SurfaceBatch& surfaces) {
  return HWY_DYNAMIC_DISPATCH(ReconstructLanes)(lanes, u, v, begin, surfaces);
}

}  // namespace sightline
#endif
