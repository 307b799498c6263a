// Random numbers of the procedural scenes: a pure function of a seed, the same on every platform.
#pragma once

#include <cmath>
#include <cstdint>

#include "base/math/vec.h"

namespace sightline::builtin {

/// Mixes 64 bits so that neighbours become unrelated [Steele2014].
inline std::uint64_t mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/// A stream of numbers for one object: seeded by scene seed and object number, so objects may be made in any order.
class Seeded {
 public:
  Seeded(std::uint64_t seed, std::uint64_t object) : state_(mix(mix(seed) ^ object)) {}

  std::uint64_t bits() { return mix(state_++); }
  float uniform() { return static_cast<float>(bits() >> 40) * 0x1p-24f; }
  float uniform(float low, float high) { return low + (high - low) * uniform(); }
  /// Whole number in [0, count).
  int below(int count) { return static_cast<int>((bits() >> 32) * static_cast<std::uint64_t>(count) >> 32); }
  Vec3 on_sphere() {
    const float z = uniform(-1, 1), phi = uniform(0, 2 * kPi), r = std::sqrt(std::fmax(0.f, 1 - z * z));
    return {r * std::cos(phi), r * std::sin(phi), z};
  }
  Vec3 in_ball() { return on_sphere() * std::cbrt(uniform()); }

 private:
  std::uint64_t state_;
};

}  // namespace sightline::builtin
