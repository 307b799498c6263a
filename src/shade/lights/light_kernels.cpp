#include "shade/lights/light_kernels.h"

#include <cstddef>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shade/lights/light_kernels.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/simd/vec3-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

using namespace lanes;

using DU8 = hn::Rebind<std::uint8_t, D>;
using I = hn::Vec<DI>;

HWY_INLINE V3 load3(const float* x, const float* y, const float* z, std::size_t i) {
  const D d;
  return {hn::LoadU(d, x + i), hn::LoadU(d, y + i), hn::LoadU(d, z + i)};
}
HWY_INLINE void store_bytes(M set, std::uint8_t* target) {
  const DI di;
  const DU8 d8;
  const I ones = hn::IfThenElseZero(hn::RebindMask(di, set), hn::Set(di, 1));
  hn::StoreU(hn::DemoteTo(d8, ones), d8, target);
}

/// Records of words: the same one for all lanes, or one a lane.
struct SameRecord {
  const float* words;
  V get(int word) const { return hn::Set(D(), words[word]); }
  I get_bits(int word) const {
    std::int32_t bits;
    __builtin_memcpy(&bits, words + word, sizeof(bits));
    return hn::Set(DI(), bits);
  }
};
struct RecordPerLane {
  const float* words;
  I offset;
  V get(int word) const { return hn::GatherIndex(D(), words + word, offset); }
  I get_bits(int word) const { return hn::BitCast(DI(), get(word)); }
};
template <class Record>
HWY_INLINE V3 get3(const Record& record, int word) {
  return {record.get(word), record.get(word + 1), record.get(word + 2)};
}

HWY_INLINE M has_flag(I flags, std::uint32_t flag) {
  return hn::RebindMask(D(), hn::TestBit(flags, hn::Set(DI(), static_cast<std::int32_t>(flag))));
}

constexpr int kFlatWords = sizeof(FlatLight) / 4, kEmitterWords = sizeof(FlatEmitter) / 4, kPunctualWords = sizeof(PunctualLight) / 4;

/// sample_flat() and view_flat() of flat_light.h.
template <class Light, class Emitter>
HWY_INLINE void sample_flat_vector(const LightLanes& lanes, const Light& light, const Emitter& emitter, I entry, V selection, std::size_t i,
                                   LightSampleBatch& out, std::size_t o) {
  const D d;
  const V zero = hn::Zero(d);
  const I flags = emitter.get_bits(3);
  const V u0 = hn::LoadU(d, lanes.u0 + i), u1 = hn::LoadU(d, lanes.u1 + i);
  const auto lower = hn::Lt(u0, u1);
  const V half = hn::Mul(hn::Set(d, 0.5f), hn::IfThenElse(lower, u0, u1));
  const auto triangle = has_flag(flags, FlatEmitter::kTriangle);
  const V a = hn::IfThenElse(triangle, hn::IfThenElse(lower, half, hn::Sub(u0, half)), u0);
  const V b = hn::IfThenElse(triangle, hn::IfThenElse(lower, hn::Sub(u1, half), half), u1);

  const V3 origin = get3(light, 0), e1 = get3(light, 3), e2 = get3(light, 6), normal = get3(light, 9);
  const auto along = [&](V from, V first, V second) { return hn::Add(hn::Add(from, hn::Mul(first, a)), hn::Mul(second, b)); };
  const V3 point{along(origin.x, e1.x, e2.x), along(origin.y, e1.y, e2.y), along(origin.z, e1.z, e2.z)};

  const V3 to_point = sub3(point, load3(lanes.x, lanes.y, lanes.z, i));
  const V squared = dot3(to_point, to_point);
  const V distance = hn::Sqrt(squared);
  const V inverse = hn::IfThenElseZero(hn::Gt(squared, zero), hn::Div(hn::Set(d, 1.f), distance));
  const V away = dot3(to_point, normal);
  const V facing = hn::IfThenElse(has_flag(flags, FlatEmitter::kTwoSided), hn::Abs(away), hn::Sub(zero, away));
  const V pdf = hn::Div(hn::Mul(selection, hn::Mul(squared, distance)), hn::Mul(light.get(12), facing));
  const auto seen = hn::And(hn::Gt(facing, zero), hn::Lt(pdf, hn::Set(d, std::numeric_limits<float>::infinity())));
  const V seen_pdf = hn::IfThenElseZero(seen, pdf);
  const auto lit = hn::Gt(seen_pdf, zero);
  const V3 radiance = get3(emitter, 0);

  store3(d, scale3(to_point, inverse), out.wi, o);
  store3(d, point, out.point, o);
  store3(d, normal, out.normal, o);
  store3(d, {hn::IfThenElseZero(lit, radiance.x), hn::IfThenElseZero(lit, radiance.y), hn::IfThenElseZero(lit, radiance.z)}, out.radiance,
         o);
  hn::StoreU(distance, d, out.distance.data() + o);
  hn::StoreU(light.get(13), d, out.point_error.data() + o);
  hn::StoreU(seen_pdf, d, out.pdf.data() + o);
  hn::StoreU(hn::BitCast(DU(), entry), DU(), out.light.data() + o);
  store_bytes(has_flag(flags, FlatEmitter::kMesh), out.is_mesh.data() + o);
  store_bytes(hn::Lt(zero, zero), out.is_delta.data() + o);
}

std::size_t SampleFlats(const LightLanes& lanes, const FlatLight* lights, const FlatEmitter* emitters, LightSampleBatch& out,
                        std::size_t first) {
  const D d;
  const DI di;
  const std::size_t n = hn::Lanes(d);
  const auto* light_words = reinterpret_cast<const float*>(lights);
  const auto* emitter_words = reinterpret_cast<const float*>(emitters);
  std::size_t i = 0;
  if (!lanes.light) {
    const SameRecord light{light_words + static_cast<std::size_t>(kFlatWords) * lanes.single};
    const SameRecord emitter{emitter_words + static_cast<std::size_t>(kEmitterWords) * lights[lanes.single].emitter};
    const I entry = hn::Set(di, static_cast<std::int32_t>(lanes.single));
    const V selection = hn::Set(d, lanes.single_selection);
    for (; i + n <= lanes.count; i += n) sample_flat_vector(lanes, light, emitter, entry, selection, i, out, first + i);
    return i;
  }
  for (; i + n <= lanes.count; i += n) {
    const I entry = hn::LoadU(di, reinterpret_cast<const std::int32_t*>(lanes.light) + i);
    const RecordPerLane light{light_words, hn::Mul(entry, hn::Set(di, kFlatWords))};
    const RecordPerLane emitter{emitter_words, hn::Mul(light.get_bits(14), hn::Set(di, kEmitterWords))};
    sample_flat_vector(lanes, light, emitter, entry, hn::LoadU(d, lanes.selection + i), i, out, first + i);
  }
  return i;
}

/// sample_punctual() of punctual_light.h, without spots.
template <class Light>
HWY_INLINE void sample_punctual_vector(const LightLanes& lanes, const Light& light, I entry, V selection, std::size_t i,
                                       LightSampleBatch& out, std::size_t o) {
  const D d;
  const DI di;
  const V zero = hn::Zero(d);
  const auto is_directional =
      hn::RebindMask(d, hn::Eq(light.get_bits(9), hn::Set(di, static_cast<std::int32_t>(PunctualLight::kDirectional))));
  const V3 position = get3(light, 0), direction = get3(light, 3), intensity = get3(light, 6);
  const V3 to_point = sub3(position, load3(lanes.x, lanes.y, lanes.z, i));
  const V squared = dot3(to_point, to_point);
  const V distance = hn::Sqrt(squared);
  const auto apart = hn::Gt(squared, zero);
  const V inverse = hn::IfThenElseZero(apart, hn::Div(hn::Set(d, 1.f), distance));
  const V3 wi = scale3(to_point, inverse), radiance = scale3(scale3(intensity, inverse), inverse);
  const auto choose = [&](V directional, V point) { return hn::IfThenElse(is_directional, directional, point); };

  store3(d, {choose(hn::Sub(zero, direction.x), wi.x), choose(hn::Sub(zero, direction.y), wi.y), choose(hn::Sub(zero, direction.z), wi.z)},
         out.wi, o);
  store3(d, {choose(zero, position.x), choose(zero, position.y), choose(zero, position.z)}, out.point, o);
  store3(d, {zero, zero, zero}, out.normal, o);
  store3(d, {choose(intensity.x, radiance.x), choose(intensity.y, radiance.y), choose(intensity.z, radiance.z)}, out.radiance, o);
  hn::StoreU(choose(hn::Set(d, std::numeric_limits<float>::infinity()), distance), d, out.distance.data() + o);
  hn::StoreU(zero, d, out.point_error.data() + o);
  hn::StoreU(choose(selection, hn::IfThenElseZero(apart, selection)), d, out.pdf.data() + o);
  hn::StoreU(hn::BitCast(DU(), entry), DU(), out.light.data() + o);
  store_bytes(hn::Lt(zero, zero), out.is_mesh.data() + o);
  store_bytes(hn::Eq(zero, zero), out.is_delta.data() + o);
}

std::size_t SamplePunctuals(const LightLanes& lanes, const PunctualLight* lights, std::uint32_t first_entry, LightSampleBatch& out,
                            std::size_t first) {
  const D d;
  const DI di;
  const std::size_t n = hn::Lanes(d);
  const auto* words = reinterpret_cast<const float*>(lights);
  std::size_t i = 0;
  if (!lanes.light) {
    const SameRecord light{words + static_cast<std::size_t>(kPunctualWords) * (lanes.single - first_entry)};
    const I entry = hn::Set(di, static_cast<std::int32_t>(lanes.single));
    const V selection = hn::Set(d, lanes.single_selection);
    for (; i + n <= lanes.count; i += n) sample_punctual_vector(lanes, light, entry, selection, i, out, first + i);
    return i;
  }
  const I base = hn::Set(di, static_cast<std::int32_t>(first_entry));
  for (; i + n <= lanes.count; i += n) {
    const I entry = hn::LoadU(di, reinterpret_cast<const std::int32_t*>(lanes.light) + i);
    const RecordPerLane light{words, hn::Mul(hn::Sub(entry, base), hn::Set(di, kPunctualWords))};
    sample_punctual_vector(lanes, light, entry, hn::LoadU(d, lanes.selection + i), i, out, first + i);
  }
  return i;
}

/// AliasTable::sample() without the stretched number.
std::size_t PickLights(const AliasTable::Bin* bins, const float* probabilities, std::size_t bin_count, const float* u, std::size_t count,
                       std::uint32_t* light, float* probability) {
  const D d;
  const DI di;
  const std::size_t n = hn::Lanes(d);
  const V bin_count_float = hn::Set(d, static_cast<float>(bin_count));
  const I last = hn::Set(di, static_cast<std::int32_t>(bin_count - 1));
  const auto* words = reinterpret_cast<const float*>(bins);
  std::size_t i = 0;
  for (; i + n <= count; i += n) {
    const V scaled = hn::Mul(hn::LoadU(d, u + i), bin_count_float);
    const auto inside = hn::And(hn::Ge(scaled, hn::Zero(d)), hn::Lt(scaled, bin_count_float));
    const I bin = hn::IfThenElse(hn::RebindMask(di, inside), hn::ConvertTo(di, hn::IfThenElseZero(inside, scaled)), last);
    const V rest = hn::Sub(scaled, hn::ConvertTo(d, bin));
    const I offset = hn::Add(bin, bin);
    const V threshold = hn::GatherIndex(d, words, offset);
    const I alias = hn::BitCast(di, hn::GatherIndex(d, words + 1, offset));
    const I index = hn::IfThenElse(hn::RebindMask(di, hn::Lt(rest, threshold)), bin, alias);
    hn::StoreU(index, di, reinterpret_cast<std::int32_t*>(light) + i);
    hn::StoreU(hn::GatherIndex(d, probabilities, index), d, probability + i);
  }
  return i;
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
HWY_EXPORT(SampleFlats);
HWY_EXPORT(SamplePunctuals);
HWY_EXPORT(PickLights);

// Vector code reads the records as arrays of words.
static_assert(offsetof(FlatLight, e2) == 6 * 4 && offsetof(FlatLight, normal) == 9 * 4 && offsetof(FlatLight, area) == 12 * 4 &&
              offsetof(FlatLight, point_error) == 13 * 4 && offsetof(FlatLight, emitter) == 14 * 4);
static_assert(offsetof(FlatEmitter, flags) == 3 * 4 && sizeof(FlatEmitter) % 4 == 0);
static_assert(offsetof(PunctualLight, intensity) == 6 * 4 && offsetof(PunctualLight, kind) == 9 * 4 && sizeof(PunctualLight) % 4 == 0);
static_assert(sizeof(AliasTable::Bin) == 8);

std::size_t sample_flat_lanes(const LightLanes& lanes, const FlatLight* lights, const FlatEmitter* emitters, LightSampleBatch& samples,
                              std::size_t first) {
  return HWY_DYNAMIC_DISPATCH(SampleFlats)(lanes, lights, emitters, samples, first);
}
std::size_t sample_punctual_lanes(const LightLanes& lanes, const PunctualLight* lights, std::uint32_t first_entry,
                                  LightSampleBatch& samples, std::size_t first) {
  return HWY_DYNAMIC_DISPATCH(SamplePunctuals)(lanes, lights, first_entry, samples, first);
}
std::size_t pick_lights(const AliasTable& table, const float* u, std::size_t count, std::uint32_t* light, float* probability) {
  if (table.size() > (std::size_t{1} << 30)) return 0;
  return HWY_DYNAMIC_DISPATCH(PickLights)(table.bins().data(), table.probabilities().data(), table.size(), u, count, light, probability);
}
}  // namespace sightline
#endif
