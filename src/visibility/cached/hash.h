// Slot and digest of a key: the scalar definitions of the three hashes. The vector versions in look_up_lanes.cpp give the same bits.
#pragma once

#include <cstdint>

#include "visibility/cached/key.h"
#include "visibility/cached/settings.h"

namespace sightline {

/// Where an answer is kept, and the 32 bits it is recognised by, of which the slot's format uses the upper ones.
struct CacheSlot {
  std::uint32_t index = 0, digest = 0;
  friend bool operator==(const CacheSlot&, const CacheSlot&) = default;
};

/// Constants of the hashes. Multipliers are odd; those of steps spread multiples of a small number over the whole range
/// (2^32 and 2^26 divided by the golden ratio).
struct HashConstants {
  static constexpr std::uint32_t kMix1 = 0x9e3779b1u, kMix2 = 0x85ebca77u, kMix3 = 0xc2b2ae3du, kMix4 = 0x27d4eb2fu;
  static constexpr std::uint32_t kStepX = 0x9e3779b9u, kStepY = 0x278dde7u << 6;
  static constexpr std::uint32_t kEyeA = 0x243f6a88u, kEyeB = 0x85a308d3u;
  /// Generators of [Press2007, §7.1].
  static constexpr std::uint32_t kC1Mul = 1664525u, kC1Add = 1013904223u, kC2Mul = 2891336453u, kC2Add = 1640531513u;
  static constexpr std::uint64_t kC64Mul = 2862933555777941757ull, kC64Add = 7046029254386353087ull;
};

/// Half of mix_pair.
constexpr void half_mix_pair(std::uint32_t& a, std::uint32_t& b) {
  using H = HashConstants;
  std::uint32_t t = b * H::kMix1;
  t ^= t >> 15;
  a = (a ^ t) * H::kMix2;
  a ^= a >> 16;
  b ^= a;
}

/// A bijection of 64 bits in two halves in which every bit of the input changes about half of those of the output.
constexpr void mix_pair(std::uint32_t& a, std::uint32_t& b) {
  using H = HashConstants;
  half_mix_pair(a, b);
  b *= H::kMix3;
  b ^= b >> 15;
  a = (a ^ b) * H::kMix4;
  a ^= a >> 14;
  b += a;
}

/// Eye part: linear in the 4x4 block that the cell lies in, so that neighbours differ by constants.
constexpr EndPart eye_part(const EndWords& w) {
  using H = HashConstants;
  std::uint32_t a = w.z + H::kEyeA, b = (w.packed & ~EndWords::kUnknown) + H::kEyeB;
  mix_pair(a, b);
  const auto block = [](std::uint32_t i) { return static_cast<std::uint32_t>(static_cast<std::int32_t>(i) >> 2); };
  a += block(w.x) * H::kStepX;
  b = (b & ~EndPart::kLow) + block(w.y) * H::kStepY;
  return {a, b | (w.x & 3) | ((w.y & 3) << 2) | (w.unknown() ? EndPart::kUnknownEye : 0)};
}

/// Light part: made for every query where light samples are not shared, so no more than must be. z is in both halves, so that no two
/// cells with the same y fall together; half a mixing takes away the structure, which the eye part still has.
constexpr EndPart light_part(const EndWords& w, CacheSalt salt) {
  using H = HashConstants;
  std::uint32_t a = w.x * H::kMix2 + w.z * H::kMix3 + salt.a;
  std::uint32_t b = (w.y * H::kMix4 + w.z * H::kMix1 + salt.b) ^ (w.packed & ~EndWords::kUnknown);
  half_mix_pair(a, b);
  return {a, (b & ~EndPart::kLow) | (w.unknown() ? EndPart::kUnknownLight : 0)};
}

/// Cells of a block of 4x4 share a cache line of 16 slots.
constexpr CacheSlot separable_slot(EndPart eye, EndPart light, int table_bits) {
  std::uint32_t a = eye.a ^ light.a, b = (eye.b ^ light.b) & ~EndPart::kLow;
  mix_pair(a, b);
  return {(a >> (36 - table_bits) << 4) | (eye.b & EndPart::kCell), b};
}

/// The words of a key in the paper's order: semantic first, so that keys of different length cannot be taken for each other.
template <class Take>
constexpr void for_each_word(const EndWords& eye, const EndWords& light, const Take& take) {
  take(light.semantic());
  take(eye.axis(0)), take(eye.axis(1)), take(eye.axis(2));
  take(eye.x), take(eye.y), take(eye.z), take(eye.level());
  switch (static_cast<QuerySemantic>(light.semantic())) {
    case QuerySemantic::surface:
      take(light.axis(0)), take(light.axis(1)), take(light.axis(2));
      take(light.x), take(light.y), take(light.z), take(light.level());
      break;
    case QuerySemantic::solid_angle:
      take(light.x), take(light.y), take(light.level());
      break;
    case QuerySemantic::point:
    case QuerySemantic::direction:
      take(light.x), take(light.y), take(light.z);
  }
}

/// [Popov2013, Eq. 10] with the generators of [Press2007].
constexpr CacheSlot recurrence_slot(const EndWords& eye, const EndWords& light, CacheSalt salt, int table_bits) {
  using H = HashConstants;
  std::uint32_t kappa = salt.a, c = salt.b;
  for_each_word(eye, light, [&](std::uint32_t j) {
    kappa = (kappa * H::kC1Mul + H::kC1Add) ^ j;
    c = (c * H::kC2Mul + H::kC2Add) + j;
  });
  return {(kappa * H::kC1Mul + H::kC1Add) >> (32 - table_bits), c * H::kC2Mul + H::kC2Add};
}

/// The paper's second hash: a 64-bit congruential generator and a xorshift in turn.
constexpr CacheSlot mix64_slot(const EndWords& eye, const EndWords& light, CacheSalt salt, int table_bits) {
  using H = HashConstants;
  std::uint64_t d = (static_cast<std::uint64_t>(salt.a) << 32) | salt.b;
  const auto step = [](std::uint64_t x) {
    x = x * H::kC64Mul + H::kC64Add;
    x ^= x >> 21, x ^= x << 35, x ^= x >> 4;
    return x;
  };
  for_each_word(eye, light, [&](std::uint32_t j) { d = step(d) ^ j; });
  d = step(d);
  // The paper keeps the lower 31 bits; shifted by one they stand where the slot has them.
  return {static_cast<std::uint32_t>(d >> 32) >> (32 - table_bits), static_cast<std::uint32_t>(d) << 1};
}

constexpr CacheSlot cache_slot(CacheHash hash, const EndWords& eye, const EndWords& light, CacheSalt salt, int table_bits) {
  switch (hash) {
    case CacheHash::separable:
      return separable_slot(eye_part(eye), light_part(light, salt), table_bits);
    case CacheHash::recurrence:
      return recurrence_slot(eye, light, salt, table_bits);
    case CacheHash::mix64:
      break;
  }
  return mix64_slot(eye, light, salt, table_bits);
}

}  // namespace sightline
