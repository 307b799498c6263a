// PlanarOccluder::Seen::distances(): all lights of a receiver at once.
#include <algorithm>

#include "methods/square_lights/planar_occluder.h"
#include "methods/square_lights/shade_lanes.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "methods/square_lights/planar_lanes.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include <hwy/contrib/math/math-inl.h>

#include "base/simd/vec3-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::square_lights::HWY_NAMESPACE {

using namespace sightline::HWY_NAMESPACE::lanes;

HWY_ATTR void PlanarDistances(std::span<const Vec3> out, const LightSet& lights, float plane_scale, float* HWY_RESTRICT distances) {
  const D d;
  const V one = hn::Set(d, 1.f), plane_unit = hn::Set(d, 0.70710678f), scale = hn::Set(d, plane_scale);
  for (std::size_t i = 0; i < lights.x.size(); i += hn::Lanes(d)) {
    const V3 c{hn::Load(d, lights.x.data() + i), hn::Load(d, lights.y.data() + i), hn::Load(d, lights.z.data() + i)};
    V sine = hn::Set(d, -1.f);
    for (const Vec3& edge : out) sine = hn::Max(sine, dot3(c, set3(d, edge)));
    // Seen::distance() of planar_occluder.cpp.
    const V most = hn::Mul(hn::Load(d, lights.r.data() + i), scale), least = hn::Mul(sine, plane_unit);
    const V exact = hn::Min(most, hn::Mul(hn::CallAsin(d, hn::Min(sine, one)), plane_unit));
    hn::StoreU(hn::IfThenElse(hn::Ge(hn::Abs(least), most), hn::Min(least, most), exact), d, distances + i);
  }
}

}  // namespace sightline::square_lights::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::square_lights {
HWY_EXPORT(PlanarDistances);

void PlanarOccluder::Seen::distances(const LightSet& lights, float plane_scale, std::span<float> distances) const {
  HWY_DYNAMIC_DISPATCH(PlanarDistances)(out_, lights, plane_scale, distances.data());
}

}  // namespace sightline::square_lights
#endif
