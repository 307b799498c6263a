#include "methods/square_lights/shade_lanes.h"

#include <algorithm>
#include <array>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "methods/square_lights/shade_lanes.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "base/simd/vec3-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::square_lights::HWY_NAMESPACE {

using namespace sightline::HWY_NAMESPACE::lanes;

struct V2 {
  V x, y;
};

HWY_INLINE V fused_dot3(const V3& a, const V3& b) { return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z))); }

HWY_INLINE V3 to_local(D d, const Frame3& frame, const V3& w) {
  return {fused_dot3(set3(d, frame.tangent), w), fused_dot3(set3(d, frame.bitangent), w), fused_dot3(set3(d, frame.normal), w)};
}

// disk_from_direction of hemisphere_disk.h.
HWY_INLINE V2 disk(D d, const V3& w) {
  const V one = hn::Set(d, 1.f);
  const V length2 = hn::Max(hn::MulAdd(w.x, w.x, hn::Mul(w.y, w.y)), hn::Set(d, 1e-30f));
  const V above = hn::Div(one, hn::Sqrt(hn::Max(hn::Add(one, w.z), hn::Set(d, 1e-6f))));
  const V below = hn::Sqrt(hn::Div(hn::Sub(one, w.z), length2));
  const V scale = hn::IfThenElse(hn::Gt(w.z, hn::Set(d, -0.5f)), above, below);
  return {hn::Mul(w.y, scale), hn::Mul(w.x, scale)};
}

/// The four codes around places of a table, and where between them.
struct Corners {
  V c00, c10, c01, c11, tx, ty;
};

HWY_INLINE Corners corners_at(D d, const std::int8_t* table, const V2& p) {
  const DI di;
  const V half = hn::Set(d, 0.5f * kTableSize), last = hn::Set(d, kTableSize - 1.f), zero = hn::Zero(d);
  const V shift = hn::Set(d, 0.5f * kTableSize - 0.5f);
  const V gx = hn::Min(hn::Max(hn::MulAdd(p.x, half, shift), zero), last), gy = hn::Min(hn::Max(hn::MulAdd(p.y, half, shift), zero), last);
  const hn::Vec<DI> most = hn::Set(di, kTableSize - 2);
  const hn::Vec<DI> ix = hn::Min(hn::ConvertTo(di, gx), most), iy = hn::Min(hn::ConvertTo(di, gy), most);
  const hn::Vec<DI> offset = hn::Add(hn::ShiftLeft<5>(iy), ix);
  // Two neighbours along a row come with one load of four bytes, of which the upper two are not looked at.
  const auto* base = reinterpret_cast<const std::int32_t*>(table);
  const hn::Vec<DI> upper = hn::GatherOffset(di, base, offset),
                    lower = hn::GatherOffset(di, base, hn::Add(offset, hn::Set(di, kTableSize)));
  const auto low_byte = [&](hn::Vec<DI> v) { return hn::ConvertTo(d, hn::ShiftRight<24>(hn::ShiftLeft<24>(v))); };
  const auto high_byte = [&](hn::Vec<DI> v) { return hn::ConvertTo(d, hn::ShiftRight<24>(hn::ShiftLeft<16>(v))); };
  return {low_byte(upper),
          high_byte(upper),
          low_byte(lower),
          high_byte(lower),
          hn::Sub(gx, hn::ConvertTo(d, ix)),
          hn::Sub(gy, hn::ConvertTo(d, iy))};
}

HWY_INLINE V mix(V a, V b, V t) { return hn::MulAdd(hn::Sub(b, a), t, a); }

HWY_ATTR void SelfDistances(const ReceiverTables& tables, const LightSet& lights, float* distance, float* gradient_x, float* gradient_y) {
  const D d;
  const V step = hn::Set(d, kDistanceStep), per_cell = hn::Set(d, kDistanceStep * 0.5f * kTableSize);
  for (std::size_t i = 0; i < lights.x.size(); i += hn::Lanes(d)) {
    const V3 c{hn::Load(d, lights.x.data() + i), hn::Load(d, lights.y.data() + i), hn::Load(d, lights.z.data() + i)};
    V sum = hn::Zero(d);
    for (int j = 0; j < tables.count; ++j) {
      const Corners q = corners_at(d, tables.table[j], disk(d, to_local(d, tables.frame[j], c)));
      const V up = mix(q.c00, q.c10, q.tx), down = mix(q.c01, q.c11, q.tx);
      sum = hn::MulAdd(hn::Set(d, tables.weight[j]), hn::Mul(mix(up, down, q.ty), step), sum);
      if (gradient_x == nullptr || j > 0) continue;
      hn::StoreU(hn::Mul(per_cell, mix(hn::Sub(q.c10, q.c00), hn::Sub(q.c11, q.c01), q.ty)), d, gradient_x + i);
      hn::StoreU(hn::Mul(per_cell, hn::Sub(down, up)), d, gradient_y + i);
    }
    hn::StoreU(sum, d, distance + i);
  }
}

HWY_ATTR void MultiplyParallel(const float* distance, const LightSet& lights, float plane_scale, float* visible) {
  const D d;
  const V one = hn::Set(d, 1.f), zero = hn::Zero(d), half = hn::Set(d, 0.5f);
  // covered_parallel of distance_table.h: h is half the edge on the disk.
  const V to_edge = hn::Set(d, 2 * 0.70710678f * plane_scale), least = hn::Set(d, 1e-12f);
  for (std::size_t i = 0; i < lights.x.size(); i += hn::Lanes(d)) {
    const V edge = hn::Max(hn::Mul(hn::Load(d, lights.r.data() + i), to_edge), least);
    const V covered = hn::Min(hn::Max(hn::Add(half, hn::Div(hn::LoadU(d, distance + i), edge)), zero), one);
    hn::StoreU(hn::Mul(hn::LoadU(d, visible + i), covered), d, visible + i);
  }
}

/// Where the edges of squares fall in the grid of a summed-area table: columns or rows and how far beyond them.
struct Edges {
  alignas(64) std::array<std::int32_t, kLanes> left, right, top, bottom;
  alignas(64) std::array<float, kLanes> fl, fr, ft, fb, weight;
};

HWY_INLINE void place_edge(D d, V at, std::int32_t* cell, float* fraction) {
  const DI di;
  const V zero = hn::Zero(d), last = hn::Set(d, static_cast<float>(BrdfTable::kCells));
  const V half = hn::Set(d, 0.5f * BrdfTable::kCells);
  const V g = hn::Min(hn::Max(hn::MulAdd(at, half, half), zero), last);
  const hn::Vec<DI> i = hn::Min(hn::ConvertTo(di, g), hn::Set(di, BrdfTable::kCells - 1));
  hn::Store(i, di, cell);
  hn::Store(hn::Sub(g, hn::ConvertTo(d, i)), d, fraction);
}

// Two texels of four channels at once where vectors are long enough.
using Texels = hn::CappedTag<float, 8>;

/// Integral of the weighted tables over [left, right] x [top, bottom], of the left (first half) or right (second half) texels of each pair
/// of neighbours that corners fall between: both halves are to be added up. `at` is where in the pair a vector begins.
HWY_INLINE hn::Vec<Texels> SquareIntegral(Texels dt, const BrdfTable::Slices& slices, const Edges& e, std::size_t lane, std::size_t at) {
  constexpr std::size_t row = std::size_t{BrdfTable::kCorners} * 4;
  const std::size_t left = static_cast<std::size_t>(e.left[lane]) * 4 + at, right = static_cast<std::size_t>(e.right[lane]) * 4 + at;
  const std::size_t top = static_cast<std::size_t>(e.top[lane]) * row, bottom = static_cast<std::size_t>(e.bottom[lane]) * row;
  // S(bottom) - S(top), each between two rows.
  const auto ft = hn::Set(dt, e.ft[lane]), fb = hn::Set(dt, e.fb[lane]), one = hn::Set(dt, 1.f);
  const auto top0 = hn::Sub(ft, one), top1 = hn::Neg(ft), bottom0 = hn::Sub(one, fb);
  // S(right) - S(left): the texels of a pair have weights (1 - f, f).
  alignas(32) static constexpr float kFirst[8] = {1, 1, 1, 1, 0, 0, 0, 0}, kSlope[8] = {-1, -1, -1, -1, 1, 1, 1, 1};
  const auto first = hn::Load(dt, kFirst + at), slope = hn::Load(dt, kSlope + at);
  const auto right_weight = hn::MulAdd(slope, hn::Set(dt, e.fr[lane]), first);
  const auto left_weight = hn::MulAdd(slope, hn::Set(dt, e.fl[lane]), first);
  auto total = hn::Zero(dt);
  for (int k = 0; k < slices.count; ++k) {
    const float* const upper = slices.table[k] + top;
    const float* const lower = slices.table[k] + bottom;
    const auto column = [&](std::size_t x) {
      auto sum = hn::Mul(hn::LoadU(dt, upper + x), top0);
      sum = hn::MulAdd(hn::LoadU(dt, upper + row + x), top1, sum);
      sum = hn::MulAdd(hn::LoadU(dt, lower + x), bottom0, sum);
      return hn::MulAdd(hn::LoadU(dt, lower + row + x), fb, sum);
    };
    const auto difference = hn::NegMulAdd(column(left), left_weight, hn::Mul(column(right), right_weight));
    total = hn::MulAdd(hn::Set(dt, slices.weight[k]), difference, total);
  }
  return total;
}

HWY_ATTR Color Shade(const Frame3& frame, const BrdfTable::Slices& slices, const LightSet& lights, const float* visible, float plane_scale,
                     std::size_t& lit) {
  const D d;
  const V one = hn::Set(d, 1.f), zero = hn::Zero(d);
  const V scale = hn::Set(d, plane_scale), half_edge = hn::Set(d, 0.70710678f);
  const V cosine = hn::Set(d, slices.turn.x), sine = hn::Set(d, slices.turn.y);
  const float factor = 1 / (plane_scale * plane_scale);
  Edges e;
  const Texels dt;
  constexpr std::size_t kParts = 8 / hn::MaxLanes(Texels());
  hn::Vec<Texels> total[kParts];
  for (auto& part : total) part = hn::Zero(dt);
  for (std::size_t i = 0; i < lights.x.size(); i += hn::Lanes(d)) {
    const V3 c{hn::Load(d, lights.x.data() + i), hn::Load(d, lights.y.data() + i), hn::Load(d, lights.z.data() + i)};
    const V v = hn::LoadU(d, visible + i);
    if (hn::AllFalse(d, hn::Gt(v, zero))) continue;
    const V2 q = disk(d, to_local(d, frame, c));
    const V2 p{hn::MulSub(q.x, cosine, hn::Mul(q.y, sine)), hn::MulAdd(q.x, sine, hn::Mul(q.y, cosine))};
    const V r = hn::Mul(hn::Load(d, lights.r.data() + i), scale), own = hn::Mul(r, half_edge);
    // Below half a cell the differences of sums are all rounding: a larger square's mean is taken (BrdfTable::kLeastHalf).
    const V h = hn::Max(own, hn::Set(d, BrdfTable::kLeastHalf)), share = hn::Div(own, h);
    // Squares beyond the horizon.
    const V reach = hn::Add(one, r), distance2 = hn::MulAdd(p.x, p.x, hn::Mul(p.y, p.y));
    const M on = hn::And(hn::Gt(v, zero), hn::And(hn::Lt(distance2, hn::Mul(reach, reach)), hn::Gt(r, zero)));
    if (hn::AllFalse(d, on)) continue;
    hn::Store(hn::IfThenElseZero(on, hn::Mul(v, hn::Mul(share, share))), d, e.weight.data());
    place_edge(d, hn::Sub(p.x, h), e.left.data(), e.fl.data()), place_edge(d, hn::Add(p.x, h), e.right.data(), e.fr.data());
    place_edge(d, hn::Sub(p.y, h), e.top.data(), e.ft.data()), place_edge(d, hn::Add(p.y, h), e.bottom.data(), e.fb.data());
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
      if (!(e.weight[lane] > 0)) continue;
      ++lit;
      const auto light = hn::Mul(hn::LoadDup128(dt, lights.radiance.data() + (i + lane) * 4), hn::Set(dt, factor * e.weight[lane]));
      for (std::size_t part = 0; part < kParts; ++part)
        total[part] = hn::MulAdd(light, SquareIntegral(dt, slices, e, lane, part * hn::Lanes(dt)), total[part]);
    }
  }
  alignas(32) std::array<float, 8> sums;
  for (std::size_t part = 0; part < kParts; ++part) hn::Store(total[part], dt, sums.data() + part * hn::Lanes(dt));
  return {sums[0] + sums[4], sums[1] + sums[5], sums[2] + sums[6]};
}

}  // namespace sightline::square_lights::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::square_lights {
HWY_EXPORT(SelfDistances);
HWY_EXPORT(MultiplyParallel);
HWY_EXPORT(Shade);

void LightSet::clear() {
  for (AlignedVector<float>* values : {&x, &y, &z, &r, &radiance}) values->clear();
  count = 0;
}

void LightSet::reserve(std::size_t n) {
  for (AlignedVector<float>* values : {&x, &y, &z, &r}) values->reserve(padded(n));
  radiance.reserve(4 * padded(n));
}

void LightSet::add(const SquareLight& light) {
  x.push_back(light.center.x), y.push_back(light.center.y), z.push_back(light.center.z), r.push_back(light.radius);
  radiance.insert(radiance.end(), {light.radiance.x, light.radiance.y, light.radiance.z, 0});
  ++count;
}

void LightSet::finish() {
  const std::size_t n = padded(count);
  x.resize(n, 0), y.resize(n, 0), z.resize(n, 1), r.resize(n, 0);
  radiance.resize(4 * n, 0);
}

void LightSet::turned_from(const LightSet& other, const Mat3& rotation) {
  count = other.count, r = other.r, radiance = other.radiance;
  x.resize(other.x.size()), y.resize(other.y.size()), z.resize(other.z.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3 c = normalize_or(rotation * Vec3(other.x[i], other.y[i], other.z[i]), Vec3(0, 0, 1));
    x[i] = c.x, y[i] = c.y, z[i] = c.z;
  }
}

SquareLight LightSet::light(std::size_t i) const {
  return {{x[i], y[i], z[i]}, r[i], {radiance[4 * i], radiance[4 * i + 1], radiance[4 * i + 2]}};
}

void self_distances(const ReceiverTables& tables, const LightSet& lights, std::span<float> distance, std::span<float> gradient_x,
                    std::span<float> gradient_y) {
  if (tables.count == 0) {
    std::fill(distance.begin(), distance.end(), kNoOccluder);
    std::fill(gradient_x.begin(), gradient_x.end(), 0.f), std::fill(gradient_y.begin(), gradient_y.end(), 0.f);
    return;
  }
  HWY_DYNAMIC_DISPATCH(SelfDistances)
  (tables, lights, distance.data(), gradient_x.empty() ? nullptr : gradient_x.data(), gradient_y.empty() ? nullptr : gradient_y.data());
}

void multiply_coverage(std::span<const float> distance, std::span<const float> gradient_x, std::span<const float> gradient_y,
                       const LightSet& lights, float plane_scale, Coverage coverage, std::span<float> visible) {
  if (coverage == Coverage::parallel) {
    HWY_DYNAMIC_DISPATCH(MultiplyParallel)(distance.data(), lights, plane_scale, visible.data());
    return;
  }
  for (std::size_t i = 0; i < lights.count; ++i) {
    const float r_p = lights.r[i] * plane_scale;
    const bool direct = coverage == Coverage::gradient && !gradient_x.empty();
    visible[i] *= direct ? covered_gradient(distance[i], {gradient_x[i], gradient_y[i]}, r_p) : covered_average(distance[i], r_p);
  }
}

Color shade(const Frame3& frame, const BrdfTable::Slices& slices, const LightSet& lights, std::span<const float> visible, float plane_scale,
            std::size_t& lit) {
  return HWY_DYNAMIC_DISPATCH(Shade)(frame, slices, lights, visible.data(), plane_scale, lit);
}

}  // namespace sightline::square_lights
#endif
