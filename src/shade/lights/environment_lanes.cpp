#include "shade/lights/environment_lanes.h"

#include <cstdint>
#include <limits>

#include "shade/cube_map.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shade/lights/environment_lanes.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "base/simd/vec3-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

using namespace lanes;
using VI = hn::Vec<DI>;

// Within two units in the last place. The ratio of the shorter to the longer side is brought below tan(pi / 8), where five terms in its
// square (a Chebyshev fit, 3e-9 off) do.
HWY_INLINE V ArcTan2(D d, V y, V x) {
  const V ax = hn::Abs(x), ay = hn::Abs(y);
  const V greater = hn::Max(hn::Max(ax, ay), hn::Set(d, 1e-30f)), less = hn::Min(ax, ay);
  const M beyond = hn::Gt(less, hn::Mul(hn::Set(d, 0.41421356f), greater));
  const V top = hn::IfThenElse(beyond, hn::Sub(less, greater), less), bottom = hn::IfThenElse(beyond, hn::Add(less, greater), greater);
  const V t = hn::Div(top, bottom), t2 = hn::Mul(t, t);
  V p = hn::Set(d, -0.06451927870512009f);
  for (const float c : {0.10743731260299683f, -0.14263956248760223f, 0.19999539852142334f, -0.3333333134651184f})
    p = hn::MulAdd(p, t2, hn::Set(d, c));
  V angle = hn::MulAdd(hn::Mul(t, t2), p, t);
  angle = hn::IfThenElse(beyond, hn::Add(angle, hn::Set(d, 0.25f * kPi)), angle);
  angle = hn::IfThenElse(hn::Gt(ay, ax), hn::Sub(hn::Set(d, 0.5f * kPi), angle), angle);
  angle = hn::IfThenElse(hn::Lt(x, hn::Zero(d)), hn::Sub(hn::Set(d, kPi), angle), angle);
  return hn::CopySignToAbs(angle, y);
}

HWY_INLINE VI Clamped(DI di, VI i, int count) { return hn::Min(hn::Max(i, hn::Zero(di)), hn::Set(di, count - 1)); }

/// The stored colour of texels whose coordinates are within the picture.
HWY_INLINE V3 Texel(D d, DI di, const EnvironmentPicture& picture, VI x, VI y) {
  const VI at = hn::Mul(hn::Add(hn::Mul(y, hn::Set(di, picture.width)), x), hn::Set(di, picture.channels));
  const V red = hn::GatherIndex(d, picture.values, at);
  if (picture.channels < 3) return {red, red, red};
  return {red, hn::GatherIndex(d, picture.values + 1, at), hn::GatherIndex(d, picture.values + 2, at)};
}

// environment_uv().
HWY_INLINE void LatLongPlace(D d, const V3& w, V& u, V& v) {
  const V sine = hn::Sqrt(hn::Add(hn::Mul(w.x, w.x), hn::Mul(w.z, w.z)));
  u = hn::Add(hn::Set(d, 0.5f), hn::Mul(ArcTan2(d, w.x, hn::Neg(w.z)), hn::Set(d, 0.5f * kInvPi)));
  v = hn::Mul(ArcTan2(d, sine, w.y), hn::Set(d, kInvPi));
}
HWY_INLINE void AngularPlace(D d, const V3& w, V& u, V& v) {
  const V sine = hn::Sqrt(hn::Add(hn::Mul(w.x, w.x), hn::Mul(w.y, w.y))), half = hn::Set(d, 0.5f);
  const V radius = hn::Mul(ArcTan2(d, sine, hn::Neg(w.z)), hn::Set(d, kInvPi)), one = hn::Set(d, 1.f);
  const M off_axis = hn::Gt(sine, hn::Zero(d));
  const V safe = hn::IfThenElse(off_axis, sine, one);
  const V x = hn::IfThenElse(off_axis, hn::Div(w.x, safe), one), y = hn::IfThenElseZero(off_axis, hn::Div(w.y, safe));
  u = hn::Add(half, hn::Mul(hn::Mul(half, radius), x));
  v = hn::Sub(half, hn::Mul(hn::Mul(half, radius), y));
}

// EnvironmentMap::radiance_uv().
HWY_INLINE V3 Between(D d, const EnvironmentPicture& picture, V u, V v) {
  const DI di;
  const auto place = [&](V at, int count) {
    const V inside = hn::Min(hn::Max(at, hn::Zero(d)), hn::Set(d, 1.f));
    return hn::Sub(hn::Mul(inside, hn::Set(d, static_cast<float>(count))), hn::Set(d, 0.5f));
  };
  const V x = place(u, picture.width), y = place(v, picture.height);
  const V left = hn::Floor(x), top = hn::Floor(y), fx = hn::Sub(x, left), fy = hn::Sub(y, top), one = hn::Set(d, 1.f);
  const VI i = hn::ConvertTo(di, left), j = hn::ConvertTo(di, top), next = hn::Add(i, hn::Set(di, 1)), width = hn::Set(di, picture.width);
  VI x0 = i, x1 = next;
  // Columns of latitude and longitude go on at the other side; rows, and what is outside of a disk, do not.
  if (picture.mapping == EnvironmentMapping::latlong) {
    x0 = hn::IfThenElse(hn::Lt(i, hn::Zero(di)), hn::Add(i, width), i);
    x1 = hn::IfThenElse(hn::Lt(next, width), next, hn::Sub(next, width));
  }
  x0 = Clamped(di, x0, picture.width), x1 = Clamped(di, x1, picture.width);
  const VI y0 = Clamped(di, j, picture.height), y1 = Clamped(di, hn::Add(j, hn::Set(di, 1)), picture.height);
  const auto mix = [&](const V3& a, const V3& b, V t) { return add3(scale3(a, hn::Sub(one, t)), scale3(b, t)); };
  const V3 upper = mix(Texel(d, di, picture, x0, y0), Texel(d, di, picture, x1, y0), fx);
  const V3 lower = mix(Texel(d, di, picture, x0, y1), Texel(d, di, picture, x1, y1), fx);
  return mix(upper, lower, fy);
}

HWY_INLINE V3 Picture(D d, const EnvironmentPicture& picture, const V3& w) {
  V u, v;
  if (picture.mapping == EnvironmentMapping::angular)
    AngularPlace(d, w, u, v);
  else
    LatLongPlace(d, w, u, v);
  return Between(d, picture, u, v);
}

// EnvironmentMap::cube_texel().
HWY_INLINE V3 Cube(D d, const EnvironmentPicture& picture, const V3& w) {
  const DI di;
  const V ax = hn::Abs(w.x), ay = hn::Abs(w.y), az = hn::Abs(w.z), zero = hn::Zero(d);
  const M on_x = hn::And(hn::Ge(ax, ay), hn::Ge(ax, az)), on_y = hn::AndNot(on_x, hn::Ge(ay, az));
  const V longest = hn::IfThenElse(on_x, ax, hn::IfThenElse(on_y, ay, az)),
          along = hn::IfThenElse(on_x, w.x, hn::IfThenElse(on_y, w.y, w.z));
  const M positive = hn::Gt(along, zero);
  const V minus_z = hn::Neg(w.z), minus_y = hn::Neg(w.y);
  const V side =
      hn::IfThenElse(on_x, hn::IfThenElse(positive, minus_z, w.z), hn::IfThenElse(on_y, w.x, hn::IfThenElse(positive, w.x, hn::Neg(w.x))));
  const V down = hn::IfThenElse(on_y, hn::IfThenElse(positive, w.z, minus_z), minus_y);
  const VI first =
      hn::IfThenElse(hn::RebindMask(di, on_x), hn::Zero(di), hn::IfThenElse(hn::RebindMask(di, on_y), hn::Set(di, 2), hn::Set(di, 4)));
  const VI face = hn::IfThenElse(hn::RebindMask(di, positive), first, hn::Add(first, hn::Set(di, 1)));
  const auto index = [&](V part) {
    const V at =
        hn::Mul(hn::Mul(hn::Add(hn::Div(part, longest), hn::Set(d, 1.f)), hn::Set(d, 0.5f)), hn::Set(d, static_cast<float>(picture.width)));
    return Clamped(di, hn::ConvertTo(di, at), picture.width);
  };
  return Texel(d, di, picture, index(side), hn::Add(hn::Mul(face, hn::Set(di, picture.width)), index(down)));
}

void EnvironmentRadiance(const EnvironmentPicture& picture, const Vec3Batch& direction, std::size_t count, Vec3Batch& radiance) {
  const D d;
  const Mat3& m = picture.local_from_world;
  const V3 to_x = set3(d, {m[0].x, m[1].x, m[2].x}), to_y = set3(d, {m[0].y, m[1].y, m[2].y}), to_z = set3(d, {m[0].z, m[1].z, m[2].z});
  const V3 scale = set3(d, picture.scale);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const V3 w = load3(d, direction, i);
    const V3 local{dot3(to_x, w), dot3(to_y, w), dot3(to_z, w)};
    const V3 color = picture.mapping == EnvironmentMapping::cube ? Cube(d, picture, local) : Picture(d, picture, local);
    store3(d, mul3(scale, color), radiance, i);
  }
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
HWY_EXPORT(EnvironmentRadiance);

bool EnvironmentPicture::has_lanes() const {
  const bool known = mapping != EnvironmentMapping::octahedral;
  return known && std::int64_t{width} * height * channels <= std::numeric_limits<std::int32_t>::max();
}

void environment_radiance(const EnvironmentPicture& picture, const Vec3Batch& direction, std::size_t count, Vec3Batch& radiance) {
  if (radiance.x.size() < padded(count)) radiance.resize(count);
  HWY_DYNAMIC_DISPATCH(EnvironmentRadiance)(picture, direction, count, radiance);
}

}  // namespace sightline
#endif
