#include "base/sample/sobol.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/sample/sobol.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<std::uint32_t, 16>;
using V = hn::Vec<D>;

// Half bytes through a table, then the bytes of each word in reverse.
HWY_INLINE V reverse_bits_v(D d, V x) {
  const hn::Repartition<std::uint8_t, D> db;
  alignas(16) constexpr std::uint8_t kReversed[16] = {0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15};
  alignas(16) constexpr std::uint8_t kReversedHigh[16] = {0x00, 0x80, 0x40, 0xc0, 0x20, 0xa0, 0x60, 0xe0,
                                                          0x10, 0x90, 0x50, 0xd0, 0x30, 0xb0, 0x70, 0xf0};
  alignas(16) constexpr std::uint8_t kSwapBytes[16] = {3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12};
  const V low_half = hn::Set(d, 0x0f0f0f0fu);
  const auto low = hn::BitCast(db, hn::And(x, low_half)), high = hn::BitCast(db, hn::And(hn::ShiftRight<4>(x), low_half));
  const auto reversed =
      hn::Or(hn::TableLookupBytes(hn::LoadDup128(db, kReversedHigh), low), hn::TableLookupBytes(hn::LoadDup128(db, kReversed), high));
  return hn::BitCast(d, hn::TableLookupBytes(reversed, hn::LoadDup128(db, kSwapBytes)));
}

HWY_INLINE V hash32_v(D d, V x) {
  x = hn::Xor(x, hn::ShiftRight<16>(x));
  x = hn::Mul(x, hn::Set(d, 0x7feb352du));
  x = hn::Xor(x, hn::ShiftRight<15>(x));
  x = hn::Mul(x, hn::Set(d, 0x846ca68bu));
  return hn::Xor(x, hn::ShiftRight<16>(x));
}

HWY_INLINE V laine_karras_v(D d, V x, V seed) {
  x = hn::Xor(x, hn::Mul(x, hn::Set(d, 0x3d20adeau)));
  x = hn::Add(x, seed);
  x = hn::Mul(x, hn::Or(hn::ShiftRight<16>(seed), hn::Set(d, 1u)));
  x = hn::Xor(x, hn::Mul(x, hn::Set(d, 0x05526c56u)));
  return hn::Xor(x, hn::Mul(x, hn::Set(d, 0x53a22864u)));
}

HWY_INLINE V sobol1_reversed_v(D d, V x) {
  x = hn::Xor(x, hn::And(hn::ShiftRight<1>(x), hn::Set(d, 0x55555555u)));
  x = hn::Xor(x, hn::And(hn::ShiftRight<2>(x), hn::Set(d, 0x33333333u)));
  x = hn::Xor(x, hn::And(hn::ShiftRight<4>(x), hn::Set(d, 0x0f0f0f0fu)));
  x = hn::Xor(x, hn::And(hn::ShiftRight<8>(x), hn::Set(d, 0x00ff00ffu)));
  return hn::Xor(x, hn::ShiftRight<16>(x));
}

// hash_combine(key, pair)
HWY_INLINE V pair_key_v(D d, V key, std::uint32_t pair) {
  const V sum = hn::Add(hn::Set(d, pair * 0x9e3779b9u + 0x85ebca6bu), hn::Add(hn::ShiftLeft<6>(key), hn::ShiftRight<2>(key)));
  return hash32_v(d, hn::Xor(key, sum));
}

HWY_INLINE V shuffled_index_v(D d, V index, V pair_key) {
  const V second_key = hash32_v(d, hn::Xor(pair_key, hn::Set(d, 0x2545f491u)));
  return reverse_bits_v(d, laine_karras_v(d, laine_karras_v(d, reverse_bits_v(d, index), pair_key), second_key));
}

HWY_INLINE void store_unit(V bits, float* to) {
  const hn::RebindToSigned<D> di;
  const hn::RebindToFloat<D> df;
  hn::Store(hn::Mul(hn::ConvertTo(df, hn::BitCast(di, hn::ShiftRight<8>(bits))), hn::Set(df, 0x1p-24f)), df, to);
}

void Sobol2d(const std::uint32_t* HWY_RESTRICT keys, const std::uint32_t* HWY_RESTRICT indices, std::uint32_t pair, std::size_t count,
             float* HWY_RESTRICT u, float* HWY_RESTRICT v) {
  const D d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const V pair_key = pair_key_v(d, hn::Load(d, keys + i), pair);
    const V shuffled = shuffled_index_v(d, hn::Load(d, indices + i), pair_key);
    const V key_x = hash32_v(d, hn::Xor(pair_key, hn::Set(d, 0xa511e9b3u)));
    store_unit(reverse_bits_v(d, laine_karras_v(d, shuffled, key_x)), u + i);
    const V key_y = hash32_v(d, hn::Xor(pair_key, hn::Set(d, 0x63d83595u)));
    store_unit(reverse_bits_v(d, laine_karras_v(d, sobol1_reversed_v(d, shuffled), key_y)), v + i);
  }
}

void Sobol1d(const std::uint32_t* HWY_RESTRICT keys, const std::uint32_t* HWY_RESTRICT indices, std::uint32_t pair, std::size_t count,
             float* HWY_RESTRICT u) {
  const D d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const V pair_key = pair_key_v(d, hn::Load(d, keys + i), pair);
    const V shuffled = shuffled_index_v(d, hn::Load(d, indices + i), pair_key);
    const V key_x = hash32_v(d, hn::Xor(pair_key, hn::Set(d, 0xa511e9b3u)));
    store_unit(reverse_bits_v(d, laine_karras_v(d, shuffled, key_x)), u + i);
  }
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
HWY_EXPORT(Sobol2d);
HWY_EXPORT(Sobol1d);

void sobol_2d(const std::uint32_t* keys, const std::uint32_t* indices, std::uint32_t pair, std::size_t count, float* u, float* v) {
  HWY_DYNAMIC_DISPATCH(Sobol2d)(keys, indices, pair, count, u, v);
}

void sobol_1d(const std::uint32_t* keys, const std::uint32_t* indices, std::uint32_t pair, std::size_t count, float* u) {
  HWY_DYNAMIC_DISPATCH(Sobol1d)(keys, indices, pair, count, u);
}

}  // namespace sightline
#endif
