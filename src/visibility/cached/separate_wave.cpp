#include "visibility/cached/separate_wave.h"

#include <algorithm>

namespace sightline {

void SeparateWave::look_up(std::size_t slot, const QueryBatch& queries, RayCounts& rays, VisibilityCounts& counts) {
  std::unique_ptr<CachedWorker> worker;
  {
    const std::lock_guard lock(mutex_);
    if (!idle_.empty()) worker = std::move(idle_.back()), idle_.pop_back();
  }
  if (!worker) worker = std::make_unique<CachedWorker>(core_);
  Slot& own = slots_[slot];
  own.size = queries.size;
  own.weights.resize(std::max(own.weights.size(), padded(queries.size)));
  worker->begin(static_cast<std::uint32_t>(slot));
  worker->visible(queries, own.weights, rays, counts);
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(worker));
}

void SeparateWave::resolve(std::size_t slot, std::span<float> weights) {
  std::copy_n(slots_[slot].weights.data(), slots_[slot].size, weights.data());
}

}  // namespace sightline
