#include "methods/square_lights/occluder_place.h"

#include <algorithm>
#include <cmath>

#include "shade/cube_map.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "methods/square_lights/occluder_place.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include <hwy/contrib/math/math-inl.h>

#include "base/simd/vec3-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::square_lights::HWY_NAMESPACE {

using namespace sightline::HWY_NAMESPACE::lanes;

constexpr float kShellsPerLog = (kShells - 1) / 2.7080502f;  // ln(kOuterShell / kInnerShell)

HWY_INLINE V3 LoadRow(D d, const AlignedVector<float>* rows, std::size_t i) {
  return {hn::Load(d, rows[0].data() + i), hn::Load(d, rows[1].data() + i), hn::Load(d, rows[2].data() + i)};
}
HWY_INLINE void StoreRow(D d, const V3& v, AlignedVector<float>* rows, std::size_t i) {
  hn::Store(v.x, d, rows[0].data() + i), hn::Store(v.y, d, rows[1].data() + i), hn::Store(v.z, d, rows[2].data() + i);
}

/// Texel before the coordinate `u` of a face, and the rest.
HWY_INLINE void StoreTexel(D d, V u, std::int32_t* cell, float* fraction) {
  const DI di;
  const V at = hn::Sub(hn::Mul(hn::Add(u, hn::Set(d, 1.f)), hn::Set(d, kShellSize / 2.f)), hn::Set(d, 0.5f));
  const auto x = hn::Min(hn::Max(hn::ConvertTo(di, hn::Floor(at)), hn::Set(di, -1)), hn::Set(di, kShellSize - 1));
  hn::Store(x, di, cell);
  hn::Store(hn::Min(hn::Max(hn::Sub(at, hn::ConvertTo(d, x)), hn::Zero(d)), hn::Set(d, 1.f)), d, fraction);
}

HWY_ATTR void Places(const OccluderLanes& occluders, const Vec3& position, OccluderPlaces& p) {
  const D d;
  const DI di;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.f), half = hn::Set(d, 0.5f);
  for (std::size_t i = 0; i < occluders.radius.size(); i += hn::Lanes(d)) {
    const V3 to = sub3(LoadRow(d, occluders.center.data(), i), set3(d, position));
    const V distance = hn::Sqrt(dot3(to, to)), rho = hn::Div(distance, hn::Load(d, occluders.radius.data() + i));
    const V sine = hn::Div(one, rho), sine2 = hn::Mul(sine, sine);
    const M outside = hn::Lt(sine, one);
    const V cosine = hn::IfThenElseZero(outside, hn::Sqrt(hn::Sub(one, sine2)));
    const V outline = hn::IfThenElse(outside, hn::Sqrt(hn::Div(sine2, hn::Add(one, cosine))), one);
    StoreRow(d, to, p.to.data(), i);
    hn::Store(distance, d, p.distance.data() + i), hn::Store(rho, d, p.rho.data() + i);
    hn::Store(sine, d, p.sine.data() + i), hn::Store(cosine, d, p.cosine.data() + i), hn::Store(outline, d, p.outline.data() + i);
    hn::Store(hn::Sqrt(hn::Sub(one, hn::Mul(half, hn::Mul(outline, outline)))), d, p.outline_cosine.data() + i);

    const V level = hn::Min(
        hn::Max(hn::Mul(hn::Log(d, hn::Div(hn::Max(rho, hn::Set(d, 1e-6f)), hn::Set(d, kInnerShell))), hn::Set(d, kShellsPerLog)), zero),
        hn::Set(d, kShells - 1.f));
    const auto shell = hn::Min(hn::ConvertTo(di, level), hn::Set(di, kShells - 2));
    hn::Store(shell, di, p.shell.data() + i), hn::Store(hn::Sub(level, hn::ConvertTo(d, shell)), d, p.between.data() + i);

    const M apart = hn::Gt(distance, zero);
    const V inverse = hn::Div(one, hn::IfThenElse(apart, distance, one));
    const auto* const turn = occluders.turn.data();
    const V3 turned =
        scale3(V3{dot3(LoadRow(d, turn, i), to), dot3(LoadRow(d, turn + 3, i), to), dot3(LoadRow(d, turn + 6, i), to)}, inverse);
    const V3 normal = select3(apart, turned, {zero, zero, hn::Neg(one)});
    StoreRow(d, normal, p.normal.data(), i);
    // cube_place() of the direction from the centre to the point.
    const V3 out = neg3(normal), size = {hn::Abs(out.x), hn::Abs(out.y), hn::Abs(out.z)};
    const M by_x = hn::And(hn::Ge(size.x, size.y), hn::Ge(size.x, size.z)), by_y = hn::AndNot(by_x, hn::Ge(size.y, size.z));
    const V longest = hn::IfThenElse(by_x, out.x, hn::IfThenElse(by_y, out.y, out.z));
    const M ahead = hn::Gt(longest, zero);
    const auto flip = [&](V v) { return hn::IfThenElse(ahead, v, hn::Neg(v)); };
    const V u = hn::IfThenElse(by_x, flip(normal.z), hn::IfThenElse(by_y, out.x, flip(out.x)));
    const V v = hn::IfThenElse(by_y, flip(out.z), normal.y), length = hn::Abs(longest);
    const auto axis =
        hn::IfThenElse(hn::RebindMask(di, by_x), hn::Zero(di), hn::IfThenElse(hn::RebindMask(di, by_y), hn::Set(di, 2), hn::Set(di, 4)));
    hn::Store(hn::Add(axis, hn::IfThenElse(hn::RebindMask(di, ahead), hn::Zero(di), hn::Set(di, 1))), di, p.face.data() + i);
    StoreTexel(d, hn::Div(u, length), p.x.data() + i, p.fraction_x.data() + i);
    StoreTexel(d, hn::Div(v, length), p.y.data() + i, p.fraction_y.data() + i);
  }
}

}  // namespace sightline::square_lights::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::square_lights {
HWY_EXPORT(Places);

float shell_radius(int k) {
  static const std::array<float, kShells> radii = [] {
    std::array<float, kShells> r;
    for (int i = 0; i < kShells; ++i) r[i] = kInnerShell * std::pow(kOuterShell / kInnerShell, static_cast<float>(i) / (kShells - 1));
    return r;
  }();
  return radii[static_cast<std::size_t>(k)];
}

float apparent_radius(float rho) {
  if (rho <= 1) return 1;
  // 1 - cos, in a form that keeps its digits far away.
  const float sin2 = 1 / (rho * rho);
  return std::sqrt(sin2 / (1 + std::sqrt(1 - sin2)));
}

OccluderPlace occluder_place(const Vec3& away) {
  OccluderPlace place;
  place.rho = glm::length(away);
  const Vec3 out = normalize_or(away, Vec3(0, 0, 1));
  place.normal = -out;
  place.outline = apparent_radius(place.rho);
  place.outline_cosine = std::sqrt(1 - 0.5f * place.outline * place.outline);

  constexpr float shells_per_log = (kShells - 1) / 2.7080502f;  // ln(kOuterShell / kInnerShell)
  const float level = std::clamp(std::log(std::max(place.rho, 1e-6f) / kInnerShell) * shells_per_log, 0.f, static_cast<float>(kShells - 1));
  place.shell = std::min(static_cast<int>(level), kShells - 2);
  place.between = level - static_cast<float>(place.shell);

  const CubePlace cube = cube_place(out);
  const float u = (cube.u + 1) * (kShellSize / 2.f) - 0.5f, v = (cube.v + 1) * (kShellSize / 2.f) - 0.5f;
  place.face = cube.face;
  place.x = std::clamp(static_cast<int>(std::floor(u)), -1, kShellSize - 1);
  place.y = std::clamp(static_cast<int>(std::floor(v)), -1, kShellSize - 1);
  place.fraction_x = std::clamp(u - static_cast<float>(place.x), 0.f, 1.f);
  place.fraction_y = std::clamp(v - static_cast<float>(place.y), 0.f, 1.f);
  return place;
}

void OccluderLanes::add(const Vec3& c, float r, const Mat3& m) {
  for (int k = 0; k < 3; ++k) {
    const auto row = static_cast<std::size_t>(k) * 3;
    center[static_cast<std::size_t>(k)].push_back(c[k]);
    for (int j = 0; j < 3; ++j) turn[row + static_cast<std::size_t>(j)].push_back(m[j][k]);
  }
  radius.push_back(r);
  ++count;
}

void OccluderLanes::finish() {
  const std::size_t n = padded(count);
  for (AlignedVector<float>& values : center) values.resize(n, 0);
  for (AlignedVector<float>& values : turn) values.resize(n, 0);
  radius.resize(n, 1);
}

OccluderCone OccluderPlaces::cone(std::size_t i) const {
  return {{to[0][i], to[1][i], to[2][i]}, distance[i], sine[i], cosine[i], !(sine[i] < 1)};
}

OccluderPlace OccluderPlaces::place(std::size_t i) const {
  return {{normal[0][i], normal[1][i], normal[2][i]},
          rho[i],
          outline[i],
          outline_cosine[i],
          shell[i],
          between[i],
          face[i],
          x[i],
          y[i],
          fraction_x[i],
          fraction_y[i]};
}

void occluder_places(const OccluderLanes& occluders, const Vec3& position, OccluderPlaces& places) {
  const std::size_t n = occluders.radius.size();
  if (places.rho.size() < n) {
    for (auto* rows : {&places.to, &places.normal}) {
      for (AlignedVector<float>& values : *rows) values.resize(n);
    }
    for (auto* values : {&places.distance, &places.sine, &places.cosine, &places.rho, &places.outline, &places.outline_cosine,
                         &places.between, &places.fraction_x, &places.fraction_y})
      values->resize(n);
    for (auto* values : {&places.shell, &places.face, &places.x, &places.y}) values->resize(n);
  }
  HWY_DYNAMIC_DISPATCH(Places)(occluders, position, places);
}

}  // namespace sightline::square_lights
#endif
