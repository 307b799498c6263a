// The random numbers of every method: padded, hash-based Owen-scrambled Sobol points [Burley2020].
//
// A sample value is a pure function of (seed, pixel, sample index, pair of dimensions). Each pair of dimensions uses the first two Sobol
// dimensions with its own shuffle of the index, so any prefix of the samples is a (0,2)-sequence in every pair whatever the total count.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/math/vec.h"

namespace sightline {

/// 32-bit finaliser with full avalanche ("lowbias32" by Wellons).
constexpr std::uint32_t hash32(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  x ^= x >> 16;
  return x;
}
constexpr std::uint32_t hash_combine(std::uint32_t a, std::uint32_t b) {
  return hash32(a ^ (b * 0x9e3779b9u + 0x85ebca6bu + (a << 6) + (a >> 2)));
}

/// Key of a pixel's sequences. `pixel` is y * width + x of the whole picture.
constexpr std::uint32_t pixel_key(std::uint64_t seed, std::uint32_t pixel) {
  return hash_combine(hash_combine(hash32(static_cast<std::uint32_t>(seed)), static_cast<std::uint32_t>(seed >> 32)), pixel);
}

constexpr std::uint32_t reverse_bits(std::uint32_t x) {
  x = (x >> 16) | (x << 16);
  x = ((x & 0x00ff00ffu) << 8) | ((x >> 8) & 0x00ff00ffu);
  x = ((x & 0x0f0f0f0fu) << 4) | ((x >> 4) & 0x0f0f0f0fu);
  x = ((x & 0x33333333u) << 2) | ((x >> 2) & 0x33333333u);
  return ((x & 0x55555555u) << 1) | ((x >> 1) & 0x55555555u);
}

/// Permutation that only lets low bits influence higher ones: on bit-reversed numbers it is an Owen scramble. Constants of Vegdahl's
/// improvement of the Laine–Karras hash.
constexpr std::uint32_t laine_karras(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

/// Second Sobol dimension of `index`, bit-reversed: the Pascal matrix mod 2, as a butterfly.
constexpr std::uint32_t sobol1_reversed(std::uint32_t index) {
  index ^= (index >> 1) & 0x55555555u;
  index ^= (index >> 2) & 0x33333333u;
  index ^= (index >> 4) & 0x0f0f0f0fu;
  index ^= (index >> 8) & 0x00ff00ffu;
  index ^= (index >> 16) & 0x0000ffffu;
  return index;
}

/// 24 high bits as a float in [0, 1).
constexpr float unit_float(std::uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }

/// Shuffle of the sample index: two rounds under independent keys, since in one the first 2^b indices feel only about 2b bits of the key,
/// and among millions of pixels two pairs of dimensions would then now and then share their order.
constexpr std::uint32_t shuffled_index(std::uint32_t index, std::uint32_t pair_key) {
  return reverse_bits(laine_karras(laine_karras(reverse_bits(index), pair_key), hash32(pair_key ^ 0x2545f491u)));
}

/// The scalar definition: pair `pair` of sample `index` under `key`.
inline Vec2 sobol_2d(std::uint32_t key, std::uint32_t index, std::uint32_t pair) {
  const std::uint32_t pair_key = hash_combine(key, pair);
  const std::uint32_t shuffled = shuffled_index(index, pair_key);
  const std::uint32_t x = reverse_bits(laine_karras(shuffled, hash32(pair_key ^ 0xa511e9b3u)));
  const std::uint32_t y = reverse_bits(laine_karras(sobol1_reversed(shuffled), hash32(pair_key ^ 0x63d83595u)));
  return {unit_float(x), unit_float(y)};
}

/// The same for many samples in SIMD, equal to sobol_2d bit for bit. All arrays 64-byte aligned and padded to kLanes; u and v are written
/// for padded(count) lanes.
void sobol_2d(const std::uint32_t* keys, const std::uint32_t* indices, std::uint32_t pair, std::size_t count, float* u, float* v);
/// The first number of each pair alone.
void sobol_1d(const std::uint32_t* keys, const std::uint32_t* indices, std::uint32_t pair, std::size_t count, float* u);

/// Which pair of dimensions serves what. Bounce 0 is the first surface.
namespace dimension {
inline constexpr std::uint32_t kPixel = 0;
inline constexpr std::uint32_t kLens = 1;
inline constexpr std::uint32_t kFirstBounce = 2;
inline constexpr std::uint32_t kPairsPerBounce = 4;
enum Use : std::uint32_t {
  kLightPick = 0,   ///< x: which light; y: mix material
  kLightPoint = 1,  ///< point on the light
  kLobe = 2,        ///< x: BSDF lobe; y: Russian roulette
  kDirection = 3,   ///< BSDF direction
};
constexpr std::uint32_t pair_of(std::uint32_t bounce, Use use) { return kFirstBounce + bounce * kPairsPerBounce + use; }
}  // namespace dimension

}  // namespace sightline
