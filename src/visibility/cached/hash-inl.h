// The hashes of hash.h on vectors. Included once for each SIMD target; see hwy/foreach_target.h.
#if defined(SIGHTLINE_VISIBILITY_CACHED_HASH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SIGHTLINE_VISIBILITY_CACHED_HASH_INL_H_
#undef SIGHTLINE_VISIBILITY_CACHED_HASH_INL_H_
#else
#define SIGHTLINE_VISIBILITY_CACHED_HASH_INL_H_
#endif

#include <hwy/highway.h>

#include "visibility/cached/hash.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using DU = hn::CappedTag<std::uint32_t, kLanes>;
using VU = hn::Vec<DU>;
using MU = hn::Mask<DU>;

struct WordsV {
  VU packed, x, y, z;
};
struct PartV {
  VU a, b;
};
struct SlotV {
  VU index, digest;
};

HWY_INLINE void half_mix_pair(DU d, VU& a, VU& b) {
  using H = HashConstants;
  VU t = hn::Mul(b, hn::Set(d, H::kMix1));
  t = hn::Xor(t, hn::ShiftRight<15>(t));
  a = hn::Mul(hn::Xor(a, t), hn::Set(d, H::kMix2));
  a = hn::Xor(a, hn::ShiftRight<16>(a));
  b = hn::Xor(b, a);
}

HWY_INLINE void mix_pair(DU d, VU& a, VU& b) {
  using H = HashConstants;
  half_mix_pair(d, a, b);
  b = hn::Mul(b, hn::Set(d, H::kMix3));
  b = hn::Xor(b, hn::ShiftRight<15>(b));
  a = hn::Mul(hn::Xor(a, b), hn::Set(d, H::kMix4));
  a = hn::Xor(a, hn::ShiftRight<14>(a));
  b = hn::Add(b, a);
}

/// `flag` where the end is not known.
HWY_INLINE VU unknown_flag(DU d, VU packed, std::uint32_t flag) {
  const hn::RebindToSigned<DU> di;
  return hn::And(hn::BitCast(d, hn::ShiftRight<31>(hn::BitCast(di, packed))), hn::Set(d, flag));
}

HWY_INLINE VU block_of(VU cell) {
  const hn::RebindToSigned<DU> di;
  return hn::BitCast(DU(), hn::ShiftRight<2>(hn::BitCast(di, cell)));
}

HWY_INLINE PartV eye_part(DU d, const WordsV& w) {
  using H = HashConstants;
  VU a = hn::Add(w.z, hn::Set(d, H::kEyeA));
  VU b = hn::Add(hn::And(w.packed, hn::Set(d, ~EndWords::kUnknown)), hn::Set(d, H::kEyeB));
  mix_pair(d, a, b);
  a = hn::Add(a, hn::Mul(block_of(w.x), hn::Set(d, H::kStepX)));
  b = hn::Add(hn::And(b, hn::Set(d, ~EndPart::kLow)), hn::Mul(block_of(w.y), hn::Set(d, H::kStepY)));
  const VU three = hn::Set(d, 3u);
  const VU cell = hn::Or(hn::And(w.x, three), hn::ShiftLeft<2>(hn::And(w.y, three)));
  return {a, hn::Or(hn::Or(b, cell), unknown_flag(d, w.packed, EndPart::kUnknownEye))};
}

HWY_INLINE PartV light_part(DU d, const WordsV& w, CacheSalt salt) {
  using H = HashConstants;
  VU a = hn::Add(hn::Add(hn::Mul(w.x, hn::Set(d, H::kMix2)), hn::Mul(w.z, hn::Set(d, H::kMix3))), hn::Set(d, salt.a));
  VU b = hn::Add(hn::Add(hn::Mul(w.y, hn::Set(d, H::kMix4)), hn::Mul(w.z, hn::Set(d, H::kMix1))), hn::Set(d, salt.b));
  b = hn::Xor(b, hn::And(w.packed, hn::Set(d, ~EndWords::kUnknown)));
  half_mix_pair(d, a, b);
  return {a, hn::Or(hn::And(b, hn::Set(d, ~EndPart::kLow)), unknown_flag(d, w.packed, EndPart::kUnknownLight))};
}

HWY_INLINE SlotV separable_slot(DU d, const PartV& eye, const PartV& light, int table_bits) {
  VU a = hn::Xor(eye.a, light.a), b = hn::And(hn::Xor(eye.b, light.b), hn::Set(d, ~EndPart::kLow));
  mix_pair(d, a, b);
  return {hn::Or(hn::ShiftLeft<4>(hn::ShiftRightSame(a, 36 - table_bits)), hn::And(eye.b, hn::Set(d, EndPart::kCell))), b};
}

/// Calls take(word, lanes that have it) in the order of for_each_word.
template <class Take>
HWY_INLINE void for_each_word(DU d, const WordsV& eye, const WordsV& light, const Take& take) {
  const MU all = hn::Eq(eye.x, eye.x);
  const VU mask = hn::Set(d, 63u);
  const auto axis = [&](VU packed, int i) { return hn::And(hn::ShiftRightSame(packed, EndWords::kAxisBits * i), mask); };
  const auto level = [&](VU packed) { return hn::And(hn::ShiftRight<EndWords::kLevelShift>(packed), hn::Set(d, 255u)); };
  const VU semantic = hn::And(hn::ShiftRight<EndWords::kSemanticShift>(light.packed), hn::Set(d, 3u));
  take(semantic, all);
  for (int i = 0; i < 3; ++i) take(axis(eye.packed, i), all);
  take(eye.x, all), take(eye.y, all), take(eye.z, all), take(level(eye.packed), all);
  const MU surface = hn::Eq(semantic, hn::Set(d, static_cast<std::uint32_t>(QuerySemantic::surface)));
  const MU sphere = hn::Eq(semantic, hn::Set(d, static_cast<std::uint32_t>(QuerySemantic::solid_angle)));
  for (int i = 0; i < 3; ++i) take(axis(light.packed, i), surface);
  take(light.x, all), take(light.y, all), take(hn::IfThenElse(sphere, level(light.packed), light.z), all);
  take(level(light.packed), surface);
}

HWY_INLINE SlotV recurrence_slot(DU d, const WordsV& eye, const WordsV& light, CacheSalt salt, int table_bits) {
  using H = HashConstants;
  VU kappa = hn::Set(d, salt.a), c = hn::Set(d, salt.b);
  const auto c1 = [&](VU x) { return hn::Add(hn::Mul(x, hn::Set(d, H::kC1Mul)), hn::Set(d, H::kC1Add)); };
  const auto c2 = [&](VU x) { return hn::Add(hn::Mul(x, hn::Set(d, H::kC2Mul)), hn::Set(d, H::kC2Add)); };
  for_each_word(d, eye, light, [&](VU j, MU has) {
    kappa = hn::IfThenElse(has, hn::Xor(c1(kappa), j), kappa);
    c = hn::IfThenElse(has, hn::Add(c2(c), j), c);
  });
  return {hn::ShiftRightSame(c1(kappa), 32 - table_bits), c2(c)};
}

/// Upper halves of the 64-bit products.
HWY_INLINE VU mul_high(DU d, VU x, std::uint32_t constant) {
  const hn::Repartition<std::uint64_t, DU> d64;
  const VU k = hn::Set(d, constant);
  const VU even = hn::BitCast(d, hn::ShiftRight<32>(hn::MulEven(x, k)));
  const VU odd = hn::BitCast(d, hn::MulEven(hn::BitCast(d, hn::ShiftRight<32>(hn::BitCast(d64, x))), k));
  return hn::OddEven(odd, even);
}

HWY_INLINE SlotV mix64_slot(DU d, const WordsV& eye, const WordsV& light, CacheSalt salt, int table_bits) {
  using H = HashConstants;
  constexpr auto kMulLow = static_cast<std::uint32_t>(H::kC64Mul), kMulHigh = static_cast<std::uint32_t>(H::kC64Mul >> 32);
  constexpr auto kAddLow = static_cast<std::uint32_t>(H::kC64Add), kAddHigh = static_cast<std::uint32_t>(H::kC64Add >> 32);
  VU high = hn::Set(d, salt.a), low = hn::Set(d, salt.b);
  const auto step = [&](VU& h, VU& l) {
    // 64-bit arithmetic in halves.
    VU ph = hn::Add(mul_high(d, l, kMulLow), hn::Add(hn::Mul(l, hn::Set(d, kMulHigh)), hn::Mul(h, hn::Set(d, kMulLow))));
    VU pl = hn::Mul(l, hn::Set(d, kMulLow));
    const VU sum = hn::Add(pl, hn::Set(d, kAddLow));
    const VU carry = hn::IfThenElseZero(hn::Lt(sum, pl), hn::Set(d, 1u));
    ph = hn::Add(hn::Add(ph, hn::Set(d, kAddHigh)), carry), pl = sum;
    pl = hn::Xor(pl, hn::Or(hn::ShiftRight<21>(pl), hn::ShiftLeft<11>(ph))), ph = hn::Xor(ph, hn::ShiftRight<21>(ph));
    ph = hn::Xor(ph, hn::ShiftLeft<3>(pl));
    pl = hn::Xor(pl, hn::Or(hn::ShiftRight<4>(pl), hn::ShiftLeft<28>(ph))), ph = hn::Xor(ph, hn::ShiftRight<4>(ph));
    h = ph, l = pl;
  };
  for_each_word(d, eye, light, [&](VU j, MU has) {
    VU h = high, l = low;
    step(h, l);
    high = hn::IfThenElse(has, h, high), low = hn::IfThenElse(has, hn::Xor(l, j), low);
  });
  step(high, low);
  return {hn::ShiftRightSame(high, 32 - table_bits), hn::ShiftLeft<1>(low)};
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // SIGHTLINE_VISIBILITY_CACHED_HASH_INL_H_
