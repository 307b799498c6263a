// A wave whose batches share nothing: each is answered at once, as a scope of its own.
#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "visibility/cached/worker.h"

namespace sightline {

/// As many tables as there are threads, not as there are batches.
class SeparateWave final : public VisibilityWave {
 public:
  SeparateWave(std::shared_ptr<CacheCore> core, std::size_t slots) : core_(std::move(core)), slots_(slots) {}

  void look_up(std::size_t slot, const QueryBatch& queries, RayCounts& rays, VisibilityCounts& counts) override;
  void trace(const Context&, RayCounts&, VisibilityCounts&) override {}
  void resolve(std::size_t slot, std::span<float> weights) override;

 private:
  struct Slot {
    AlignedVector<float> weights;
    std::size_t size = 0;
  };
  std::shared_ptr<CacheCore> core_;
  std::vector<Slot> slots_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<CachedWorker>> idle_;
};

}  // namespace sightline
