#include "visibility/nee_plus_plus/visibility_map.h"

#include <algorithm>

#include "base/parallel/parallel.h"

namespace sightline {
namespace {

std::uint64_t entry_count(std::uint64_t resolution, std::uint64_t directions) {
  const std::uint64_t voxels = resolution * resolution * resolution;
  return voxels * (voxels + 1) / 2 + voxels * directions * directions;
}

// Probability of tracing in 256ths, 0 for always.
std::uint8_t odds_of(std::uint64_t counts, const VisibilityMap::Limits& limits) {
  const auto tested = static_cast<std::uint32_t>(counts), visible = static_cast<std::uint32_t>(counts >> 32);
  if (tested < limits.min_tests) return 0;
  const float probability = static_cast<float>(visible) / static_cast<float>(tested);
  if (probability >= limits.sure_from) return 0;
  const float odds = std::ceil(256 * std::max(probability, limits.min_probability));
  return odds < 256 ? static_cast<std::uint8_t>(odds) : 0;
}

}  // namespace

std::uint64_t VisibilityMap::bytes(std::uint32_t resolution, std::uint32_t directions) {
  return entry_count(resolution, directions) * (sizeof(std::uint64_t) + sizeof(std::uint8_t));
}

VisibilityMap::VisibilityMap(const Bounds& bounds, std::uint32_t resolution, std::uint32_t directions)
    : resolution_(resolution),
      voxel_count_(resolution * resolution * resolution),
      directions_(directions),
      direction_begin_(voxel_count_ * (voxel_count_ + 1) / 2),
      counts_(entry_count(resolution, directions)),
      odds_(entry_count(resolution, directions)),
      changed_((entry_count(resolution, directions) + kChunk - 1) / kChunk),
      touched_(changed_.size()) {
  if (bounds.is_empty()) return;
  lower_ = bounds.lower;
  const Vec3 extent = bounds.extent();
  for (int axis = 0; axis < 3; ++axis) cells_per_unit_[axis] = extent[axis] > 0 ? static_cast<float>(resolution) / extent[axis] : 0.f;
}

std::uint32_t VisibilityMap::direction_cell(const Vec3& unit) const {
  // Octahedral map: the lower half is folded outward over the edges of the upper.
  const float size = std::fabs(unit.x) + std::fabs(unit.y) + std::fabs(unit.z);
  const float scale = size > 0 ? 1 / size : 0.f;
  const float x = unit.x * scale, y = unit.y * scale;
  const bool lower = unit.z < 0;
  const float u = lower ? std::copysign(1 - std::fabs(y), x) : x, v = lower ? std::copysign(1 - std::fabs(x), y) : y;
  const float half = 0.5f * static_cast<float>(directions_);
  return grid_cell((v + 1) * half, directions_) * directions_ + grid_cell((u + 1) * half, directions_);
}

void VisibilityMap::freeze(const Limits& limits, const Context& context) {
  constexpr std::size_t kChunksATask = 16;
  parallel_for(context, changed_.size(), kChunksATask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t chunk = begin; chunk < end; ++chunk) {
      if (changed_[chunk].exchange(0, std::memory_order_relaxed) == 0) continue;
      touched_[chunk] = 1;
      const std::size_t last = std::min(counts_.size(), (chunk + 1) * kChunk);
      for (std::size_t e = chunk * kChunk; e < last; ++e) odds_[e] = odds_of(counts_[e], limits);
    }
  });
}

std::uint64_t VisibilityMap::touched_bytes() const {
  const auto chunks = static_cast<std::uint64_t>(std::count(touched_.begin(), touched_.end(), 1));
  return chunks * kChunk * (sizeof(std::uint64_t) + sizeof(std::uint8_t));
}

}  // namespace sightline
