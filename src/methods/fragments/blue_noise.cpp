#include "methods/fragments/blue_noise.h"

#include <algorithm>
#include <cmath>

#include "base/sample/sobol.h"

namespace sightline {
namespace {

constexpr int kSize = BlueNoise::kSize;
constexpr int kReach = 8;  // where the kernel has fallen to less than 1e-4
constexpr float kSigma = 1.9f;
constexpr std::uint32_t kSeeds = BlueNoise::kCount / 10;

/// A set of cells, and how crowded each cell's surroundings are.
class Crowd {
 public:
  Crowd() {
    for (int j = -kReach; j <= kReach; ++j)
      for (int i = -kReach; i <= kReach; ++i)
        kernel_[static_cast<std::size_t>(std::ptrdiff_t{j} + kReach)][static_cast<std::size_t>(std::ptrdiff_t{i} + kReach)] =
            std::exp(-static_cast<float>(i * i + j * j) / (2 * kSigma * kSigma));
  }
  bool has(std::size_t cell) const { return taken_[cell] != 0; }
  void add(std::size_t cell) { change(cell, 1); }
  void remove(std::size_t cell) { change(cell, -1); }
  /// The cell of the set with the most around it.
  std::size_t tightest() const {
    std::size_t best = BlueNoise::kCount;
    for (std::size_t i = 0; i < BlueNoise::kCount; ++i) {
      if (taken_[i] && (best == BlueNoise::kCount || energy_[i] > energy_[best])) best = i;
    }
    return best;
  }
  /// The free cell with the least around it.
  std::size_t emptiest() const {
    std::size_t best = BlueNoise::kCount;
    for (std::size_t i = 0; i < BlueNoise::kCount; ++i) {
      if (!taken_[i] && (best == BlueNoise::kCount || energy_[i] < energy_[best])) best = i;
    }
    return best;
  }

 private:
  void change(std::size_t cell, int sign) {
    taken_[cell] = sign > 0;
    const int x = static_cast<int>(cell) % kSize, y = static_cast<int>(cell) / kSize;
    for (int j = -kReach; j <= kReach; ++j) {
      float* row = energy_.data() + ((y + j) & (kSize - 1)) * kSize;
      const float* weights = kernel_[static_cast<std::size_t>(std::ptrdiff_t{j} + kReach)].data();
      for (int i = -kReach; i <= kReach; ++i) row[(x + i) & (kSize - 1)] += static_cast<float>(sign) * weights[i + kReach];
    }
  }
  std::array<float, BlueNoise::kCount> energy_{};
  std::array<std::uint8_t, BlueNoise::kCount> taken_{};
  std::array<std::array<float, 2 * kReach + 1>, 2 * kReach + 1> kernel_{};
};

}  // namespace

BlueNoise::BlueNoise() {
  Crowd even;
  for (std::uint32_t i = 0, cells = 0; cells < kSeeds; ++i) {
    const std::size_t cell = hash32(i) % kCount;
    if (!even.has(cell)) even.add(cell), ++cells;
  }
  // Seeds move from where they crowd to where there are none, until they stay.
  for (std::uint32_t round = 0; round < 4 * kCount; ++round) {
    const std::size_t from = even.tightest();
    even.remove(from);
    const std::size_t to = even.emptiest();
    even.add(to);
    if (to == from) break;
  }
  Crowd thinned = even;
  for (std::uint32_t rank = kSeeds; rank-- > 0;) {
    const std::size_t cell = thinned.tightest();
    thinned.remove(cell), rank_[cell] = static_cast<std::uint16_t>(rank);
  }
  for (std::uint32_t rank = kSeeds; rank < kCount; ++rank) {
    const std::size_t cell = even.emptiest();
    even.add(cell), rank_[cell] = static_cast<std::uint16_t>(rank);
  }
}

const BlueNoise& BlueNoise::shared() {
  static const BlueNoise noise;
  return noise;
}

}  // namespace sightline
