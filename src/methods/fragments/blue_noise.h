// Numbers for a grid such that neighbours differ as much as they can.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace sightline {

/// A square that repeats, made by void and cluster [Ulichney1993]: ranks 0 ... kSize^2 - 1, each once. Cells with ranks below any bound lie
/// far from each other, so what follows from rank / kSize^2 has high frequencies alone.
class BlueNoise {
 public:
  static constexpr int kSize = 64;
  static constexpr std::uint32_t kCount = kSize * kSize;
  BlueNoise();
  std::uint32_t rank(std::uint32_t x, std::uint32_t y) const { return rank_[(y % kSize) * kSize + x % kSize]; }

  /// The one that all share, made when it is first asked for.
  static const BlueNoise& shared();

 private:
  std::array<std::uint16_t, kCount> rank_{};
};

}  // namespace sightline
