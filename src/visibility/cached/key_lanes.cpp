#include "visibility/cached/key_lanes.h"

#include <limits>

#include "visibility/cached/grid_math.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "visibility/cached/key_lanes.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "base/simd/vec3-inl.h"
#include "visibility/cached/hash-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

using namespace lanes;

/// GridPoint of some lanes without the area, and which of them lie in or near the scene.
struct PointV {
  V x, y, z;
  VU bins;
  M inside;
};

HWY_INLINE V half_level(D d, const GridConstants& g) { return hn::Set(d, 0.5f * g.levels_per_octave); }

HWY_INLINE V fast_log2(D d, V x) {
  using G = GridMath;
  const DI di;
  const auto bits = hn::BitCast(di, x);
  const auto exponent = hn::ShiftRight<23>(hn::Sub(bits, hn::Set(di, G::kSqrtHalfBits)));
  const V t = hn::Sub(hn::BitCast(d, hn::Sub(bits, hn::ShiftLeft<23>(exponent))), hn::Set(d, 1.f));
  const V square = hn::Mul(t, t);
  const auto pair = [&](int i) { return hn::Add(hn::Set(d, G::kLog2[i]), hn::Mul(hn::Set(d, G::kLog2[i + 1]), t)); };
  const V high = hn::Add(hn::Mul(pair(4), square), pair(2));
  return hn::Add(hn::ConvertTo(d, exponent), hn::Mul(hn::Add(hn::Mul(high, square), pair(0)), t));
}

HWY_INLINE M area_known(D d, V area) {
  return hn::And(hn::Ge(area, hn::Set(d, GridMath::kLeastArea)), hn::Le(area, hn::Set(d, GridMath::kMostArea)));
}
HWY_INLINE V log_area_of(D d, V area, M known) {
  return hn::IfThenElse(known, fast_log2(d, area), hn::Set(d, std::numeric_limits<float>::infinity()));
}

/// What neighbouring ends mostly share, remembered from one group of lanes to the next: samples of one light have one normal and often
/// one density, points of one surface one normal.
struct Memo {
  V bins, area;  ///< not a number at first: equal to nothing
  const float* frame = nullptr;
  V resolution;
  VU level;
  M known;
};

HWY_INLINE Memo no_memo(D d) {
  const V nan = hn::Set(d, std::numeric_limits<float>::quiet_NaN());
  return {nan, nan, nullptr, nan, hn::Zero(DU()), hn::Eq(nan, nan)};
}

HWY_INLINE PointV locate(D d, const GridConstants& g, const QueryEnds& ends, std::size_t i, Memo& memo) {
  const DU du;
  const DI di;
  const V one = hn::Set(d, 1.f), half = hn::Set(d, 0.5f), zero = hn::Zero(d), bin_count = hn::Set(d, g.bins);
  const auto bin = [&](const AlignedVector<float>& normal) {
    const V scaled = hn::Mul(hn::Mul(hn::Add(hn::LoadU(d, normal.data() + i), one), half), bin_count);
    const V q = hn::Floor(hn::Add(scaled, hn::Set(d, g.bin_shift)));
    // A value that is not a number becomes 0: an index must stay inside its table.
    return hn::Min(hn::Max(q, zero), bin_count);
  };
  const V qx = bin(ends.normal.x), qy = bin(ends.normal.y), qz = bin(ends.normal.z);
  // Whole numbers below 2^18: exact as floats.
  const V shift = hn::Set(d, static_cast<float>(1 << EndWords::kAxisBits));
  const V bins = hn::Add(qx, hn::Mul(shift, hn::Add(qy, hn::Mul(shift, qz))));
  PointV p;
  p.bins = hn::BitCast(du, hn::ConvertTo(di, bins));

  const auto centred = [&](const AlignedVector<float>& axis, float center) {
    return hn::Mul(hn::Sub(hn::LoadU(d, axis.data() + i), hn::Set(d, center)), hn::Set(d, g.scale));
  };
  const V px = centred(ends.position.x, g.center.x), py = centred(ends.position.y, g.center.y), pz = centred(ends.position.z, g.center.z);
  const auto sum = [&](V ax, V ay, V az) { return hn::Add(hn::Add(hn::Add(hn::Mul(px, ax), hn::Mul(py, ay)), hn::Mul(pz, az)), half); };
  const auto frame_index = [&] {
    const V stride = hn::Set(d, static_cast<float>(g.stride));
    const V frame = hn::Mul(hn::Add(qx, hn::Mul(stride, hn::Add(qy, hn::Mul(stride, qz)))), hn::Set(d, 9.f));
    return hn::ConvertTo(di, frame);
  };
  // Nine broadcasts instead of nine gathers where all lanes share a frame.
  if (!hn::AllTrue(d, hn::Eq(bins, memo.bins))) {
    const V first = hn::Set(d, hn::GetLane(bins));
    const bool same = hn::AllTrue(d, hn::Eq(bins, first));
    memo.bins = hn::Set(d, same ? hn::GetLane(bins) : std::numeric_limits<float>::quiet_NaN());
    memo.frame = same ? g.frames + hn::GetLane(frame_index()) : nullptr;
  }
  if (memo.frame != nullptr) {
    const float* f = memo.frame;
    const auto axis = [&](int k) { return sum(hn::Set(d, f[k]), hn::Set(d, f[k + 1]), hn::Set(d, f[k + 2])); };
    p.x = axis(0), p.y = axis(3), p.z = axis(6);
  } else {
    const auto index = frame_index();
    const auto axis = [&](int k) {
      return sum(hn::GatherIndex(d, g.frames + k, index), hn::GatherIndex(d, g.frames + k + 1, index),
                 hn::GatherIndex(d, g.frames + k + 2, index));
    };
    p.x = axis(0), p.y = axis(3), p.z = axis(6);
  }
  p.inside = hn::Lt(hn::Add(hn::Add(hn::Abs(p.x), hn::Abs(p.y)), hn::Abs(p.z)), hn::Set(d, GridMath::kFarthest));
  if (!g.known) p.inside = hn::Lt(one, zero);
  return p;
}

HWY_INLINE VU to_cell(D d, V x) {
  const DI di;
  (void)d;
  return hn::BitCast(DU(), hn::ConvertTo(di, hn::Floor(x)));
}

HWY_INLINE V resolution_of(D d, const GridConstants& g, V kept) {
  const DI di;
  const auto k = hn::ConvertTo(di, kept);
  const std::int32_t first = hn::GetLane(k);
  if (hn::AllTrue(di, hn::Eq(k, hn::Set(di, first)))) return hn::Set(d, g.resolution[first]);
  return hn::GatherIndex(d, g.resolution, k);
}

/// A level that is not yet rounded, rounded: its resolution, its number, and where it can be told apart.
HWY_INLINE void round_level(D d, const GridConstants& g, V level, V least, M& known, V& resolution, VU& number) {
  const V k = hn::Floor(hn::Add(level, hn::Set(d, 0.5f)));
  known = hn::And(known, hn::Le(k, hn::Set(d, g.last_level)));
  const V kept = hn::IfThenElseZero(known, hn::Max(k, least));
  resolution = resolution_of(d, g, kept);
  number = hn::ShiftLeft<EndWords::kLevelShift>(hn::BitCast(DU(), hn::ConvertTo(DI(), kept)));
}

HWY_INLINE WordsV cell_at(D d, const GridConstants& g, const PointV& p, M known, V resolution, VU number) {
  const auto coordinate = [&](V x, V scale) { return to_cell(d, hn::IfThenElseZero(known, hn::Mul(x, scale))); };
  const MU known_u = hn::RebindMask(DU(), known);
  return {hn::IfThenElse(known_u, hn::Or(p.bins, number), hn::Set(DU(), EndWords::kUnknown)), coordinate(p.x, resolution),
          coordinate(p.y, resolution), coordinate(p.z, hn::Mul(resolution, hn::Set(d, g.flatness)))};
}

/// The cell of a surface point at a level that is not yet rounded.
HWY_INLINE WordsV cell(D d, const GridConstants& g, const PointV& p, V level) {
  M known = p.inside;
  V resolution;
  VU number;
  round_level(d, g, level, hn::Zero(d), known, resolution, number);
  return cell_at(d, g, p, known, resolution, number);
}

HWY_INLINE M is_finite(D d, V log_area) { return hn::Lt(log_area, hn::Set(d, std::numeric_limits<float>::infinity())); }

HWY_INLINE void store_words(DU du, const WordsV& w, EndKeys& keys, std::size_t i) {
  hn::StoreU(w.packed, du, keys.word[0].data() + i), hn::StoreU(w.x, du, keys.word[1].data() + i);
  hn::StoreU(w.y, du, keys.word[2].data() + i), hn::StoreU(w.z, du, keys.word[3].data() + i);
}
HWY_INLINE void store_part(DU du, const PartV& p, EndKeys& keys, std::size_t i) {
  hn::StoreU(p.a, du, keys.word[0].data() + i), hn::StoreU(p.b, du, keys.word[1].data() + i);
}

void LocateLanes(const GridConstants& g, const QueryEnds& ends, GridPoints& points) {
  const D d;
  const DU du;
  Memo memo = no_memo(d);
  for (std::size_t i = 0; i < ends.size; i += hn::Lanes(d)) {
    const PointV p = locate(d, g, ends, i, memo);
    const V area = hn::LoadU(d, ends.cell_area.data() + i);
    hn::StoreU(p.x, d, points.x.data() + i), hn::StoreU(p.y, d, points.y.data() + i), hn::StoreU(p.z, d, points.z.data() + i);
    hn::StoreU(log_area_of(d, area, hn::And(p.inside, area_known(d, area))), d, points.log_area.data() + i);
    hn::StoreU(p.bins, du, points.bins.data() + i);
  }
}

void EyeKeyLanes(const GridConstants& g, const GridPoints& points, std::size_t begin, std::size_t end, float offset, bool parts,
                 EndKeys& keys) {
  const D d;
  const DU du;
  for (std::size_t i = begin; i < end; i += hn::Lanes(d)) {
    const V log_area = hn::LoadU(d, points.log_area.data() + i);
    const PointV p{hn::LoadU(d, points.x.data() + i), hn::LoadU(d, points.y.data() + i), hn::LoadU(d, points.z.data() + i),
                   hn::LoadU(du, points.bins.data() + i), is_finite(d, log_area)};
    const WordsV words = cell(d, g, p, hn::Sub(hn::Set(d, offset), hn::Mul(log_area, half_level(d, g))));
    if (parts)
      store_part(du, eye_part(du, words), keys, i);
    else
      store_words(du, words, keys, i);
  }
}

// -0 becomes 0.
HWY_INLINE VU bits_of(D d, V x) { return hn::BitCast(DU(), hn::Add(x, hn::Zero(d))); }

// Direction to the unit square, as sphere_to_square.
HWY_INLINE void to_square(D d, bool equal_area, V dx, V dy, V dz, V& u, V& v) {
  using G = GridMath;
  const V one = hn::Set(d, 1.f), zero = hn::Zero(d), half = hn::Set(d, 0.5f);
  const V x = hn::Abs(dx), y = hn::Abs(dy), z = hn::Abs(dz);
  if (equal_area) {
    const V radius = hn::Sqrt(hn::Max(hn::Sub(one, z), zero));
    const M x_larger = hn::Gt(x, y);
    const V larger = hn::IfThenElse(x_larger, x, y), smaller = hn::IfThenElse(x_larger, y, x);
    const V ratio = hn::IfThenElseZero(hn::Gt(larger, zero), hn::Div(smaller, larger));
    const V square = hn::Mul(ratio, ratio);
    V sum = hn::Set(d, G::kAtan[5]);
    for (int i = 4; i >= 0; --i) sum = hn::Add(hn::Mul(sum, square), hn::Set(d, G::kAtan[i]));
    sum = hn::Mul(sum, ratio);
    const V angle = hn::IfThenElse(hn::Gt(y, x), hn::Sub(one, sum), sum);
    v = hn::Mul(angle, radius);
    u = hn::Sub(radius, v);
  } else {
    const V norm = hn::Add(hn::Add(x, y), z);
    u = hn::Div(x, norm), v = hn::Div(y, norm);
  }
  const M below = hn::Lt(dz, zero);
  const V swapped = hn::Sub(one, v);
  v = hn::IfThenElse(below, hn::Sub(one, u), v);
  u = hn::IfThenElse(below, swapped, u);
  u = hn::Mul(hn::Add(hn::CopySign(u, dx), one), half);
  v = hn::Mul(hn::Add(hn::CopySign(v, dy), one), half);
}

HWY_INLINE WordsV sphere_cell(D d, const GridConstants& g, const QueryEnds& ends, std::size_t i, float shift) {
  const DU du;
  const V zero = hn::Zero(d), two = hn::Set(d, 2.f);
  const V area = hn::LoadU(d, ends.cell_area.data() + i);
  M known = area_known(d, area);
  const V level = hn::Sub(hn::Set(d, g.sphere_offset + shift), hn::Mul(log_area_of(d, area, known), half_level(d, g)));
  V u, v;
  to_square(d, g.equal_area, hn::LoadU(d, ends.position.x.data() + i), hn::LoadU(d, ends.position.y.data() + i),
            hn::LoadU(d, ends.position.z.data() + i), u, v);
  known = hn::And(known, hn::And(hn::And(hn::Ge(u, zero), hn::Le(u, two)), hn::And(hn::Ge(v, zero), hn::Le(v, two))));
  V resolution;
  VU number;
  round_level(d, g, level, hn::Set(d, g.first_sphere_level), known, resolution, number);
  const auto coordinate = [&](V x) { return to_cell(d, hn::IfThenElseZero(known, hn::Mul(x, resolution))); };
  return {hn::IfThenElse(hn::RebindMask(du, known), number, hn::Set(du, EndWords::kUnknown)), coordinate(u), coordinate(v), hn::Zero(du)};
}

/// The cell of a point of a light's surface by its own density [Popov2013, Eq. 7].
HWY_INLINE WordsV light_cell(D d, const GridConstants& g, const QueryEnds& ends, std::size_t i, float shift, Memo& memo) {
  const PointV p = locate(d, g, ends, i, memo);
  const V area = hn::LoadU(d, ends.cell_area.data() + i);
  if (!hn::AllTrue(d, hn::Eq(area, memo.area))) {
    memo.area = area;
    memo.known = area_known(d, area);
    const V level = hn::Sub(hn::Set(d, g.light_offset + shift), hn::Mul(log_area_of(d, area, memo.known), half_level(d, g)));
    round_level(d, g, level, hn::Zero(d), memo.known, memo.resolution, memo.level);
  }
  return cell_at(d, g, p, hn::And(p.inside, memo.known), memo.resolution, memo.level);
}

HWY_INLINE WordsV choose(hn::Mask<DU> m, const WordsV& a, const WordsV& b) {
  return {hn::IfThenElse(m, a.packed, b.packed), hn::IfThenElse(m, a.x, b.x), hn::IfThenElse(m, a.y, b.y), hn::IfThenElse(m, a.z, b.z)};
}

std::uint32_t LightKeyLanes(const GridConstants& g, const QueryEnds& ends, const std::uint8_t* HWY_RESTRICT semantic, float shift,
                            const KeyFormat& format, EndKeys& keys) {
  const D d;
  const DU du;
  const hn::Rebind<std::uint8_t, DU> bytes;
  constexpr auto kSurface = static_cast<std::uint32_t>(QuerySemantic::surface),
                 kSphere = static_cast<std::uint32_t>(QuerySemantic::solid_angle);
  std::uint32_t present = 0;
  Memo memo = no_memo(d);
  for (std::size_t i = 0; i < ends.size; i += hn::Lanes(d)) {
    const auto active = hn::FirstN(du, ends.size - i);
    const VU kind = hn::And(hn::PromoteTo(du, hn::LoadU(bytes, semantic + i)), hn::Set(du, 3u));
    const auto is = [&](std::uint32_t s) { return hn::And(active, hn::Eq(kind, hn::Set(du, s))); };
    const auto surface = is(kSurface), sphere = is(kSphere);
    const auto bare = hn::AndNot(hn::Or(surface, sphere), active);
    WordsV words{hn::Zero(du), hn::Zero(du), hn::Zero(du), hn::Zero(du)};
    if (!hn::AllFalse(du, surface)) {
      present |= 1u << kSurface;
      words = light_cell(d, g, ends, i, shift, memo);
    }
    if (!hn::AllFalse(du, sphere)) {
      present |= 1u << kSphere;
      words = choose(sphere, sphere_cell(d, g, ends, i, shift), words);
    }
    if (!hn::AllFalse(du, bare)) {
      if (!hn::AllFalse(du, is(0))) present |= 1u;
      if (!hn::AllFalse(du, is(1))) present |= 2u;
      const auto axis = [&](const AlignedVector<float>& values) { return bits_of(d, hn::LoadU(d, values.data() + i)); };
      words = choose(bare, {hn::Zero(du), axis(ends.position.x), axis(ends.position.y), axis(ends.position.z)}, words);
    }
    words.packed = hn::Or(words.packed, hn::ShiftLeft<EndWords::kSemanticShift>(kind));
    if (format.parts)
      store_part(du, light_part(du, words, format.salt), keys, i);
    else
      store_words(du, words, keys, i);
  }
  return present;
}

HWY_INLINE PointV gather_point(D d, const GridPoints& points, hn::Vec<DI> i, V& log_area) {
  log_area = hn::GatherIndex(d, points.log_area.data(), i);
  return {hn::GatherIndex(d, points.x.data(), i), hn::GatherIndex(d, points.y.data(), i), hn::GatherIndex(d, points.z.data(), i),
          hn::GatherIndex(DU(), points.bins.data(), i), is_finite(d, log_area)};
}

void ConnectionKeyLanes(const GridConstants& g, const ConnectionEnds& ends, std::size_t count, const KeyFormat& format, EndKeys& eye,
                        EndKeys& light) {
  const D d;
  const DU du;
  const DI di;
  constexpr auto kSurface = static_cast<std::uint32_t>(QuerySemantic::surface);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const VU raw_light = hn::LoadU(du, ends.light_of + i);
    const auto valid = hn::And(hn::FirstN(du, count - i), hn::Ne(raw_light, hn::Set(du, kNoQuery)));
    const auto l = hn::BitCast(di, hn::IfThenElseZero(valid, raw_light));
    const auto e = hn::BitCast(di, hn::IfThenElseZero(valid, hn::LoadU(du, ends.eye_of + i)));
    V x_area, y_area;
    const PointV x = gather_point(d, *ends.eye, e, x_area), y = gather_point(d, *ends.light, l, y_area);
    const WordsV other = {
        hn::GatherIndex(du, ends.light_words->word[0].data(), l), hn::GatherIndex(du, ends.light_words->word[1].data(), l),
        hn::GatherIndex(du, ends.light_words->word[2].data(), l), hn::GatherIndex(du, ends.light_words->word[3].data(), l)};
    // The words of every light end carry its semantic.
    const VU kind = hn::And(hn::ShiftRight<EndWords::kSemanticShift>(other.packed), hn::Set(du, 3u));
    const auto surface = hn::Eq(kind, hn::Set(du, kSurface));

    const V sum = hn::Add(x_area, y_area);
    const V both = hn::Sub(hn::Set(d, ends.symmetric_offset), hn::Mul(sum, hn::Set(d, 0.25f * g.levels_per_octave)));
    V own_offset = hn::Zero(d);
    for (std::uint32_t s = 0; s < 4; ++s)
      own_offset = hn::IfThenElse(hn::RebindMask(d, hn::Eq(kind, hn::Set(du, s))), hn::Set(d, ends.eye_offset[s]), own_offset);
    const V own = hn::Sub(own_offset, hn::Mul(x_area, half_level(d, g)));
    const WordsV eye_words = cell(d, g, x, hn::IfThenElse(hn::RebindMask(d, surface), both, own));
    WordsV light_words = cell(d, g, y, both);
    light_words.packed = hn::Or(light_words.packed, hn::ShiftLeft<EndWords::kSemanticShift>(kind));
    light_words = choose(surface, light_words, other);
    if (format.parts) {
      store_part(du, eye_part(du, eye_words), eye, i);
      store_part(du, light_part(du, light_words, format.salt), light, i);
    } else {
      store_words(du, eye_words, eye, i);
      store_words(du, light_words, light, i);
    }
  }
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
HWY_EXPORT(LocateLanes);
HWY_EXPORT(EyeKeyLanes);
HWY_EXPORT(LightKeyLanes);
HWY_EXPORT(ConnectionKeyLanes);

void locate_lanes(const GridConstants& grid, const QueryEnds& ends, GridPoints& points) {
  points.resize(ends.size);
  HWY_DYNAMIC_DISPATCH(LocateLanes)(grid, ends, points);
}
void eye_key_lanes(const GridConstants& grid, const GridPoints& points, std::size_t begin, std::size_t end, float offset, bool parts,
                   EndKeys& keys) {
  HWY_DYNAMIC_DISPATCH(EyeKeyLanes)(grid, points, begin, end, offset, parts, keys);
}
std::uint32_t light_key_lanes(const GridConstants& grid, const QueryEnds& ends, const std::uint8_t* semantic, float shift,
                              const KeyFormat& format, EndKeys& keys) {
  keys.resize(ends.size, format.parts);
  return HWY_DYNAMIC_DISPATCH(LightKeyLanes)(grid, ends, semantic, shift, format, keys);
}
void connection_key_lanes(const GridConstants& grid, const ConnectionEnds& ends, std::size_t count, const KeyFormat& format, EndKeys& eye,
                          EndKeys& light) {
  eye.resize(count, format.parts);
  light.resize(count, format.parts);
  HWY_DYNAMIC_DISPATCH(ConnectionKeyLanes)(grid, ends, count, format, eye, light);
}

}  // namespace sightline
#endif
