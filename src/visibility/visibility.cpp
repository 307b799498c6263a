#include "visibility/visibility.h"

#include <algorithm>
#include <utility>

namespace sightline {
namespace {

/// A wave that shares nothing: each batch is answered at once, by a worker with the slot as its scope.
class SeparateBatches final : public VisibilityWave {
 public:
  SeparateBatches(Visibility& visibility, std::size_t slots) : slots_(slots) {
    for (Slot& slot : slots_) slot.worker = visibility.worker();
  }
  void look_up(std::size_t slot, const QueryBatch& queries, RayCounts& rays, VisibilityCounts& counts) override {
    Slot& own = slots_[slot];
    own.weights.resize(std::max(own.weights.size(), padded(queries.size)));
    own.size = queries.size;
    own.worker->begin(static_cast<std::uint32_t>(slot));
    own.worker->visible(queries, own.weights, rays, counts);
  }
  void trace(const Context&, RayCounts&, VisibilityCounts&) override {}
  void resolve(std::size_t slot, std::span<float> weights) override {
    std::copy_n(slots_[slot].weights.data(), slots_[slot].size, weights.data());
  }

 private:
  struct Slot {
    std::unique_ptr<VisibilityWorker> worker;
    AlignedVector<float> weights;
    std::size_t size = 0;
  };
  std::vector<Slot> slots_;
};

}  // namespace

void Visibility::begin_pass(const VisibilityPass&, const Context&) {}

std::unique_ptr<VisibilityWave> Visibility::wave(std::size_t slots) { return std::make_unique<SeparateBatches>(*this, slots); }

}  // namespace sightline
