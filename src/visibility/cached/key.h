// Keys of the visibility cache: what stands for one end of a query.
#pragma once

#include <array>
#include <cstdint>

#include "base/core/aligned.h"
#include "visibility/query_batch.h"

namespace sightline {

/// Cell of one end [Popov2013, §3.3-3.5]. x, y, z: the voxel of a surface point, the bits of a position or direction, or cell u, v of the
/// sphere and 0. `packed` holds the rest: orientation (6 bits an axis), level (8 bits), semantic of the light end (2 bits), and whether
/// the end's area is not known, so that its queries are not cached.
struct EndWords {
  std::uint32_t packed = 0, x = 0, y = 0, z = 0;
  friend bool operator==(const EndWords&, const EndWords&) = default;

  static constexpr int kAxisBits = 6, kLevelShift = 18, kLevelBits = 8, kSemanticShift = 26;
  static constexpr std::uint32_t kUnknown = 0x80000000u;

  constexpr std::uint32_t axis(int i) const { return (packed >> (kAxisBits * i)) & 63; }
  constexpr std::uint32_t level() const { return (packed >> kLevelShift) & 255; }
  constexpr std::uint32_t semantic() const { return (packed >> kSemanticShift) & 3; }
  constexpr bool unknown() const { return (packed & kUnknown) != 0; }
};

/// Part of one end in the separable hash.
struct EndPart {
  std::uint32_t a = 0, b = 0;
  friend bool operator==(const EndPart&, const EndPart&) = default;
  /// Flags in b: an end whose area is not known. The low four bits of an eye part are the cell's place in its block of 4x4.
  static constexpr std::uint32_t kCell = 15, kUnknownEye = 16, kUnknownLight = 32, kLow = 63;
};

/// What separates scopes and passes: the same key has another slot and digest in each.
struct CacheSalt {
  std::uint32_t a = 0, b = 0;
};

/// Keys of many ends: EndWords (packed, x, y, z), or EndPart (a, b) in the first two arrays.
struct EndKeys {
  std::array<AlignedVector<std::uint32_t>, 4> word;
  bool in_words = false;
  void resize(std::size_t n, bool parts) {
    in_words = !parts;
    for (std::size_t i = 0; i < (parts ? 2u : 4u); ++i) {
      if (word[i].size() < padded(n)) word[i].resize(padded(n));
    }
  }
  EndWords words(std::size_t i) const { return {word[0][i], word[1][i], word[2][i], word[3][i]}; }
  EndPart part(std::size_t i) const { return {word[0][i], word[1][i]}; }
};

}  // namespace sightline
