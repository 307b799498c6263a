// Answers of a whole pass from one table, the same for any number of threads.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "visibility/cached/batch_keys.h"
#include "visibility/cached/core.h"
#include "visibility/cached/shared_table.h"
#include "visibility/query_rays.h"

namespace sightline {

/// Look-ups read the table as it was when the wave began. Misses of all slots are gathered; one ray a key is traced, for the query that
/// is first by slot and place, and answers are inserted in that order. May be used for several waves one after another.
class CachedWave final : public VisibilityWave {
 public:
  CachedWave(std::shared_ptr<CacheCore> core, std::shared_ptr<SharedTable> table, CacheSalt salt, std::size_t slots)
      : core_(std::move(core)), table_(std::move(table)), salt_(salt), slots_(slots) {}

  void look_up(std::size_t slot, const QueryBatch& queries, RayCounts& rays, VisibilityCounts& counts) override;
  void trace(const Context& context, RayCounts& rays, VisibilityCounts& counts) override;
  void resolve(std::size_t slot, std::span<float> weights) override;

 private:
  static constexpr std::size_t kParts = SharedTable::kParts;
  /// A query whose key was not in the table.
  struct Miss {
    std::uint32_t query, index, tag, depth;
    std::uint32_t key = 0;  ///< place in Part::keys
  };
  /// A key to be traced, with the query that stands for it.
  struct Key {
    std::uint32_t query, index, tag;
    bool visible = false;
  };
  struct Part {
    std::vector<Key> keys;                ///< in order of slot and query
    std::vector<std::size_t> slot_begin;  ///< first key of each slot, and the end
    VisibilityCounts counts;
  };
  /// A query of a slot that gets a ray of its own. part == kParts: one that cannot be cached.
  struct OwnRay {
    std::uint32_t query, part, key;
  };
  struct Correction {
    std::uint32_t query;
    float probability;
    bool visible;
  };
  struct Slot {
    const QueryBatch* queries = nullptr;
    AlignedVector<float> weights;
    std::vector<Miss> misses;  ///< by part, then by query
    std::array<std::size_t, kParts + 1> part_begin{};
    std::vector<std::uint32_t> keyless;
    std::vector<std::uint8_t> mark;  ///< of each query, for the residual
    std::vector<Correction> corrections;
    RayCounts rays;
    VisibilityCounts counts;
  };
  /// Memory of a thread that looks up.
  struct Scratch {
    explicit Scratch(const CacheCore& core) : keys(core.quantizer, core.settings) {}
    BatchKeys keys;
    LookUpResult result;
    AlignedVector<std::uint32_t> id, eye, light;
    std::vector<Miss> misses;
  };

  void look_up_range(Slot& own, Scratch& scratch, std::size_t group, LookUp range, VisibilityCounts& counts) const;
  void sort_misses(Slot& own, Scratch& scratch, bool by_query) const;
  void find_keys(std::size_t part);
  void trace_slot(std::size_t slot);
  void trace_residual(Slot& own, QueryTracer& tracer) const;

  std::shared_ptr<CacheCore> core_;
  std::shared_ptr<SharedTable> table_;
  CacheSalt salt_;
  std::vector<Slot> slots_;
  std::array<Part, kParts> parts_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Scratch>> idle_;
};

}  // namespace sightline
