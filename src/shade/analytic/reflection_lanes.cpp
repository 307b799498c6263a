#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "shade/analytic/polygon_plane.h"
#include "shade/analytic/reflection.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shade/analytic/reflection_lanes.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "shade/analytic/polygon_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

using namespace lanes;

// The frame of the surface's side on which wo is, tangent along wo; any tangent where wo is along the normal.
HWY_INLINE Rows3 frame_towards(D d, const V3& normal, const V3& wo) {
  const V cosine = dot3(normal, wo);
  const M below = hn::Lt(cosine, hn::Zero(d));
  const V3 n = {hn::IfThenElse(below, hn::Neg(normal.x), normal.x), hn::IfThenElse(below, hn::Neg(normal.y), normal.y),
                hn::IfThenElse(below, hn::Neg(normal.z), normal.z)};
  const V3 across = sub3(wo, scale3(n, hn::Abs(cosine)));
  const V squared = dot3(across, across);
  const Rows3 any = frame_of(d, n);
  const M usable = hn::Gt(squared, hn::Set(d, 1e-12f));
  const V3 t = select3(usable, scale3(across, hn::Div(hn::Set(d, 1.f), hn::Sqrt(squared))), any.x);
  const V3 b = {hn::Sub(hn::Mul(n.y, t.z), hn::Mul(n.z, t.y)), hn::Sub(hn::Mul(n.z, t.x), hn::Mul(n.x, t.z)),
                hn::Sub(hn::Mul(n.x, t.y), hn::Mul(n.y, t.x))};
  return {t, b, n};
}

HWY_INLINE M any_light(const V3& color) {
  const D d;
  return hn::Ne(hn::Add(hn::Add(hn::Abs(color.x), hn::Abs(color.y)), hn::Abs(color.z)), hn::Zero(d));
}

HWY_INLINE V3 non_negative(D d, const V3& v) {
  const V zero = hn::Zero(d);
  return {hn::Max(v.x, zero), hn::Max(v.y, zero), hn::Max(v.z, zero)};
}

// `diffuse`: null if only the specular part is wanted.
void ReflectPolygon(std::span<const Vec3> polygon, const PolygonPlane& plane, const ReceiverBatch& receivers, std::size_t count,
                    Vec3Batch* diffuse, Vec3Batch& specular, EmitterSides sides) {
  const D d;
  const AnalyticLobesBatch& lobes = receivers.lobes;
  const std::vector<Vec3> offsets = polygon_offsets(polygon, plane);
  const V3 centre = set3(d, plane.centre), axis = set3(d, plane.normal), black = set3(d, Vec3(0));
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const V3 position = load3(d, receivers.position, i), to_centre = sub3(centre, position);
    const PolygonView view = {polygon, offsets, plane.reach, position, to_centre};
    const V height = hn::Neg(dot3(to_centre, axis));
    const Rows3 frame = frame_towards(d, load3(d, receivers.normal, i), load3(d, receivers.wo, i));
    const auto share = [&](const Rows3& transform) {
      return seen_part(d, polygon_form_factor(d, view, frame.z, transform), height, plane.least_height, sides);
    };
    if (diffuse) {
      V3 sum = black;
      const V3 plain = load3(d, lobes.diffuse, i), wide = load3(d, lobes.wide, i);
      if (!hn::AllFalse(d, any_light(plain))) sum = scale3(plain, share(frame));
      if (!hn::AllFalse(d, any_light(wide))) {
        const V narrowed = hn::Div(hn::Set(d, 1.f), hn::Max(hn::LoadU(d, lobes.stretch.data() + i), hn::Set(d, 1e-3f)));
        sum = non_negative(d, add3(sum, scale3(wide, share({scale3(frame.x, narrowed), scale3(frame.y, narrowed), frame.z}))));
      }
      store3(d, sum, *diffuse, i);
    }
    V3 sum = black;
    const V3 color = load3(d, lobes.specular, i);
    if (!hn::AllFalse(d, any_light(color))) {
      const V m11 = hn::LoadU(d, lobes.m11.data() + i), m13 = hn::LoadU(d, lobes.m13.data() + i);
      const V m31 = hn::LoadU(d, lobes.m31.data() + i), m33 = hn::LoadU(d, lobes.m33.data() + i);
      sum = scale3(color,
                   share({add3(scale3(frame.x, m11), scale3(frame.z, m13)), frame.y, add3(scale3(frame.x, m31), scale3(frame.z, m33))}));
    }
    store3(d, sum, specular, i);
  }
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
HWY_EXPORT(ReflectPolygon);

namespace {

void black_out(Vec3Batch& batch, std::size_t count) {
  for (AlignedVector<float>* values : {&batch.x, &batch.y, &batch.z}) std::fill_n(values->begin(), padded(count), 0.f);
}

}  // namespace

void reflect_polygon(std::span<const Vec3> polygon, const ReceiverBatch& receivers, std::size_t count, Vec3Batch& diffuse,
                     Vec3Batch& specular, EmitterSides sides) {
  const PolygonPlane plane(polygon);
  if (plane.normal != Vec3(0)) return HWY_DYNAMIC_DISPATCH(ReflectPolygon)(polygon, plane, receivers, count, &diffuse, specular, sides);
  black_out(diffuse, count);
  black_out(specular, count);
}

void ltc_specular(std::span<const Vec3> polygon, const ReceiverBatch& receivers, std::size_t count, Vec3Batch& specular,
                  EmitterSides sides) {
  const PolygonPlane plane(polygon);
  if (plane.normal != Vec3(0)) return HWY_DYNAMIC_DISPATCH(ReflectPolygon)(polygon, plane, receivers, count, nullptr, specular, sides);
  black_out(specular, count);
}

}  // namespace sightline
#endif
