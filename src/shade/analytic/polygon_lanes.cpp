#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "shade/analytic/polygon.h"
#include "shade/analytic/polygon_plane.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shade/analytic/polygon_lanes.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "shade/analytic/polygon_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

using namespace lanes;

void PolygonIrradiance(std::span<const Vec3> polygon, const PolygonPlane& plane, const Vec3Batch& position, const Vec3Batch& normal,
                       std::size_t count, float* form_factor, EmitterSides sides) {
  const D d;
  const std::vector<Vec3> offsets = polygon_offsets(polygon, plane);
  const V3 centre = set3(d, plane.centre), axis = set3(d, plane.normal);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const V3 p = load3(d, position, i), to_centre = sub3(centre, p), n = load3(d, normal, i);
    const V signed_form_factor = polygon_form_factor(d, {polygon, offsets, plane.reach, p, to_centre}, n, frame_of(d, n));
    hn::StoreU(seen_part(d, signed_form_factor, hn::Neg(dot3(to_centre, axis)), plane.least_height, sides), d, form_factor + i);
  }
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
HWY_EXPORT(PolygonIrradiance);

void polygon_irradiance(std::span<const Vec3> polygon, const Vec3Batch& position, const Vec3Batch& normal, std::size_t count,
                        float* form_factor, EmitterSides sides) {
  const PolygonPlane plane(polygon);
  if (plane.normal == Vec3(0)) {
    std::fill_n(form_factor, padded(count), 0.f);
    return;
  }
  HWY_DYNAMIC_DISPATCH(PolygonIrradiance)(polygon, plane, position, normal, count, form_factor, sides);
}

}  // namespace sightline
#endif
