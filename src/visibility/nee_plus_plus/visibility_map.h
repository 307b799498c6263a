// How often voxels of the scene see each other: counts that are learnt, and probabilities frozen from them [Guo2020].
#pragma once

#include <atomic>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/core/context.h"
#include "base/math/bounds.h"
#include "base/math/vec.h"
#include "visibility/grid_cell.h"
#include "visibility/zero_pages.h"

namespace sightline {

/// Grid of voxels over the scene's bounds, an entry for each unordered pair of voxels and for each pair of a voxel and a cell of
/// directions. Look-ups read probabilities that are frozen; learning adds to counts, from any thread and in any order with the same result;
/// freeze(), for one caller while nobody does either, makes new probabilities of the counts.
class VisibilityMap {
 public:
  struct Limits {
    std::uint32_t min_tests = 32;
    float min_probability = 0.05f, sure_from = 1;
  };

  VisibilityMap(const Bounds& bounds, std::uint32_t resolution, std::uint32_t directions);
  /// Bytes of a map with all entries touched.
  static std::uint64_t bytes(std::uint32_t resolution, std::uint32_t directions);

  std::uint32_t voxel_of(const Vec3& p) const {
    const Vec3 cell = (p - lower_) * cells_per_unit_;
    return (grid_cell(cell.z, resolution_) * resolution_ + grid_cell(cell.y, resolution_)) * resolution_ + grid_cell(cell.x, resolution_);
  }
  std::uint32_t direction_cell(const Vec3& unit) const;

  /// Entry of two voxels, in either order: the matrix is symmetric, only its lower triangle exists.
  static std::uint32_t entry(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t low = a < b ? a : b, high = a < b ? b : a;
    return high * (high + 1) / 2 + low;
  }
  std::uint32_t entry_of_direction(std::uint32_t voxel, std::uint32_t cell) const { return direction_begin_ + cell * voxel_count_ + voxel; }

  /// Probability of tracing in 256ths; 0 stands for 256: always.
  std::uint8_t odds(std::uint32_t entry) const { return odds_[entry]; }
  void learn(std::uint32_t entry, std::uint32_t tested, std::uint32_t visible) {
    // Both counts in one number. Four thousand million tests of one pair carry over into `visible` by one, which harms nobody: the
    // probability is an estimate, and any probability gives the right mean.
    std::atomic_ref(counts_[entry]).fetch_add(std::uint64_t{visible} << 32 | tested, std::memory_order_relaxed);
    changed_[entry / kChunk].store(1, std::memory_order_relaxed);
  }
  void freeze(const Limits& limits, const Context& context);
  /// Bytes touched so far, as far as learning has.
  std::uint64_t touched_bytes() const;

 private:
  static constexpr std::uint32_t kChunk = 4096;

  std::uint32_t resolution_, voxel_count_, directions_, direction_begin_;
  Vec3 lower_{0}, cells_per_unit_{0};
  ZeroPages<std::uint64_t> counts_;  ///< visible in the upper half, tested in the lower
  ZeroPages<std::uint8_t> odds_;
  std::vector<std::atomic<std::uint8_t>> changed_;  ///< a chunk of entries each, since freeze()
  std::vector<std::uint8_t> touched_;
};

}  // namespace sightline
