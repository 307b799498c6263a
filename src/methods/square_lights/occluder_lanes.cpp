// OccluderField::distance() for many lights: the same operations in the same order, so that every target gives the same numbers.
#include <algorithm>
#include <array>
#include <cmath>

#include "methods/square_lights/occluder_field.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "methods/square_lights/occluder_lanes.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "base/simd/vec3-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

using namespace lanes;
using square_lights::kTableCells;
using square_lights::kTableSize;
using square_lights::OccluderSamples;

// Eight tables side by side, for two lights at once where vectors are long enough: however few lights come near an occluder, most lanes are
// of use.
using Tables = hn::CappedTag<float, 16>;
inline constexpr std::size_t kTableLanes = hn::MaxLanes(Tables());
inline constexpr std::size_t kAtOnce = std::max<std::size_t>(kTableLanes / 8, 1);  // lights
inline constexpr std::size_t kParts = 8 * kAtOnce / kTableLanes;                   // vectors for them

using TableV = hn::Vec<Tables>;
using TableI = hn::Vec<hn::RebindToSigned<Tables>>;

/// OccluderSamples as vectors.
struct TableLanes {
  TableI first;  // code
  TableV turn_x, turn_y, code_unit, cell_unit;
};

template <class Number, class Tag>
HWY_INLINE hn::Vec<Tag> LoadTables(Tag d, const Number* values) {
  if constexpr (kAtOnce == 1) {
    return hn::Load(d, values);
  } else {
    const hn::Half<Tag> half;
    const auto eight = hn::Load(half, values);
    return hn::Combine(d, eight, eight);
  }
}

HWY_INLINE TableLanes LanesOf(Tables d, const OccluderSamples& samples, std::size_t part) {
  const hn::RebindToSigned<Tables> di;
  const std::size_t i = part * kTableLanes;
  static_assert(kTableSize == 32 && kTableCells == 1024);
  return {hn::ShiftLeft<10>(LoadTables(di, samples.table.data() + i)), LoadTables(d, samples.turn_x.data() + i),
          LoadTables(d, samples.turn_y.data() + i), LoadTables(d, samples.code_unit.data() + i),
          LoadTables(d, samples.cell_unit.data() + i)};
}

/// One number for each light at once.
HWY_INLINE TableV SetLights(Tables d, const float* values) {
  if constexpr (kAtOnce == 1) {
    return hn::Set(d, values[0]);
  } else {
    const hn::Half<Tables> half;
    return hn::Combine(d, hn::Set(half, values[1]), hn::Set(half, values[0]));
  }
}

/// Two neighbouring codes of a row come in one word.
HWY_INLINE TableV BlendCodes(Tables d, const std::int8_t* table, TableI offset, TableV t) {
  const hn::RebindToSigned<Tables> di;
  const auto word = hn::GatherOffset(di, reinterpret_cast<const std::int32_t*>(table), offset);
  const auto a = hn::ConvertTo(d, hn::ShiftRight<24>(hn::ShiftLeft<24>(word)));
  const auto b = hn::ConvertTo(d, hn::ShiftRight<24>(hn::ShiftLeft<16>(word)));
  return hn::Add(a, hn::Mul(t, hn::Sub(b, a)));
}

/// What each table adds to D at places of the disk.
HWY_INLINE TableV BlendTable(Tables d, const std::int8_t* HWY_RESTRICT tables, const TableLanes& lanes, TableV px, TableV py) {
  const hn::RebindToSigned<Tables> di;
  const auto zero = hn::Zero(d), last = hn::Set(d, kTableSize - 1.f), middle = hn::Set(d, (kTableSize - 1.f) / 2);
  const auto last_corner = hn::Set(di, kTableSize - 2);
  const auto u = hn::Add(hn::Add(hn::Mul(lanes.turn_x, px), hn::Mul(lanes.turn_y, py)), middle);
  const auto v = hn::Add(hn::Sub(hn::Mul(lanes.turn_x, py), hn::Mul(lanes.turn_y, px)), middle);
  const auto cu = hn::Min(hn::Max(u, zero), last), cv = hn::Min(hn::Max(v, zero), last);
  const auto x = hn::Min(hn::ConvertTo(di, cu), last_corner), y = hn::Min(hn::ConvertTo(di, cv), last_corner);
  const auto fx = hn::Sub(cu, hn::ConvertTo(d, x)), fy = hn::Sub(cv, hn::ConvertTo(d, y));
  const auto offset = hn::Add(lanes.first, hn::Add(hn::ShiftLeft<5>(y), x));
  const auto top = BlendCodes(d, tables, offset, fx), bottom = BlendCodes(d, tables + kTableSize, offset, fx);
  const auto code = hn::Add(top, hn::Mul(fy, hn::Sub(bottom, top)));
  const auto du = hn::Sub(u, cu), dv = hn::Sub(v, cv);
  const auto beyond = hn::Sqrt(hn::Add(hn::Mul(du, du), hn::Mul(dv, dv)));
  return hn::Add(hn::Mul(lanes.code_unit, code), hn::Mul(lanes.cell_unit, beyond));
}

/// ((0 + 4) + (2 + 6)) + ((1 + 5) + (3 + 7)) of each eight numbers, at sums[0] and, for a second eight, sums[2].
template <class Tag>
HWY_INLINE void SumEights(Tag d, const hn::Vec<Tag>* parts, float* HWY_RESTRICT sums) {
  if constexpr (hn::MaxLanes(Tag()) == 16) {
    const hn::Half<Tag> eight;
    const hn::Half<hn::Half<Tag>> four;
    using Four = hn::Vec<hn::Half<hn::Half<Tag>>>;
    const auto fold = [&](hn::Vec<hn::Half<Tag>> v) { return hn::Add(hn::LowerHalf(four, v), hn::UpperHalf(four, v)); };
    const Four a = fold(hn::LowerHalf(eight, parts[0])), b = fold(hn::UpperHalf(eight, parts[0]));
    const Four pairs = hn::Add(hn::ConcatLowerLower(four, b, a), hn::ConcatUpperUpper(four, b, a));
    hn::Store(hn::Add(pairs, hn::Shuffle2301(pairs)), four, sums);
  } else {
    alignas(32) std::array<float, 8> s;
    for (std::size_t part = 0; part < kParts; ++part) hn::Store(parts[part], d, s.data() + part * kTableLanes);
    sums[0] = ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7]));
  }
}

void OccluderDistances(const std::int8_t* HWY_RESTRICT tables, const OccluderSamples& samples, const square_lights::LightLanes& lights,
                       float* HWY_RESTRICT distances) {
  const D d;
  const V one = hn::Set(d, 1.f);
  const V3 tangent = set3(d, samples.frame.tangent), bitangent = set3(d, samples.frame.bitangent), normal = set3(d, samples.frame.normal);
  const V sin_half = hn::Set(d, samples.sin_half), cos_half = hn::Set(d, samples.cos_half);
  const V hidden_edge = hn::Set(d, std::sqrt(0.5f * samples.hidden_area)), beyond_occluder = hn::Set(d, square_lights::kBeyondOccluder);
  alignas(64) std::array<float, kLanes> x, y, least_distance;
  const Tables dt;
  TableLanes lanes_of[kParts];
  for (std::size_t part = 0; part < kParts; ++part) lanes_of[part] = LanesOf(dt, samples, part);
  for (std::size_t k = 0; k < lights.count; k += hn::Lanes(d)) {
    // disk_from_direction()
    const V3 c{hn::LoadU(d, lights.x.data() + k), hn::LoadU(d, lights.y.data() + k), hn::LoadU(d, lights.z.data() + k)};
    const V lx = dot3(c, tangent), ly = dot3(c, bitangent), lz = dot3(c, normal);
    const V length2 = hn::Add(hn::Mul(lx, lx), hn::Mul(ly, ly));
    const V near_axis = hn::Div(one, hn::Sqrt(hn::Add(one, lz)));
    const V opposite = hn::Sqrt(hn::Div(hn::Sub(one, lz), hn::Max(length2, hn::Set(d, 1e-30f))));
    const V scale = hn::IfThenElse(hn::Gt(lz, hn::Set(d, -0.5f)), near_axis, opposite);
    const V px = hn::Mul(ly, scale), py = hn::Mul(lx, scale);

    const V r = hn::LoadU(d, lights.r.data() + k);
    const V reach = hn::Min(hn::Mul(hn::Set(d, 0.55f), r), one);
    const V farthest = hn::Add(hn::Mul(sin_half, hn::Sqrt(hn::Sub(one, hn::Mul(reach, reach)))), hn::Mul(cos_half, reach));
    const V place2 = hn::Add(hn::Mul(px, px), hn::Mul(py, py));
    const M out = hn::Gt(place2, hn::Mul(hn::Set(d, 2.f), hn::Mul(farthest, farthest)));
    const V half_edge = hn::Max(hn::Mul(hn::Set(d, 0.5f), r), hn::Set(d, 1e-6f));
    const V s = hn::Div(hidden_edge, half_edge);
    const V corner = hn::Mul(hn::Set(d, 1.41421356f), hn::Sub(one, s)), straight = hn::Sub(one, hn::Mul(s, s));
    const V least = hn::Mul(half_edge, hn::IfThenElse(hn::Lt(s, hn::Set(d, 0.41421356f)), corner, straight));
    hn::Store(px, d, x.data()), hn::Store(py, d, y.data());
    hn::Store(hn::IfThenElse(out, beyond_occluder, least), d, least_distance.data());
    const std::size_t lanes = std::min(hn::Lanes(d), lights.count - k);
    for (std::size_t lane = 0; lane < lanes; lane += kAtOnce) {
      const TableV vx = SetLights(dt, x.data() + lane), vy = SetLights(dt, y.data() + lane);
      TableV parts[kParts];
      for (std::size_t part = 0; part < kParts; ++part) parts[part] = BlendTable(dt, tables, lanes_of[part], vx, vy);
      alignas(16) float sums[4];
      SumEights(dt, parts, sums);
      for (std::size_t j = 0; j < kAtOnce; ++j) distances[k + lane + j] = std::max(sums[2 * j], least_distance[lane + j]);
    }
  }
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
HWY_EXPORT(OccluderDistances);
}  // namespace sightline
namespace sightline::square_lights {

void occluder_distances(const OccluderField& field, const OccluderSamples& samples, const LightLanes& lights, std::span<float> distances) {
  HWY_DYNAMIC_DISPATCH(OccluderDistances)(field.tables().data(), samples, lights, distances.data());
}

}  // namespace sightline::square_lights
#endif
