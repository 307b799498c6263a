// Answers of one thread from a table of its own, group by group.
#pragma once

#include <memory>

#include "visibility/cached/batch_keys.h"
#include "visibility/cached/core.h"
#include "visibility/cached/miss_set.h"
#include "visibility/query_rays.h"

namespace sightline {

class CachedWorker final : public VisibilityWorker {
 public:
  explicit CachedWorker(std::shared_ptr<CacheCore> core);
  ~CachedWorker() override;
  CachedWorker(const CachedWorker&) = delete;
  CachedWorker& operator=(const CachedWorker&) = delete;

  void begin(std::uint32_t scope) override;
  void visible(const QueryBatch& queries, std::span<float> weights, RayCounts& rays, VisibilityCounts& counts) override;

 private:
  struct Batch {
    const QueryBatch& queries;
    std::span<float> weights;
    RayCounts& rays;
    VisibilityCounts& counts;
  };
  /// Some queries of one group, with their ends; of the caller or in one of the scratch lists below.
  struct Range {
    const std::uint32_t *eye, *light, *id;
    std::uint32_t first;
    std::size_t count;
  };
  struct List {
    AlignedVector<std::uint32_t> eye, light, id;
    std::size_t count = 0;
  };
  void answer(const Batch& batch, std::size_t group, Range range);
  LookUp look_up_of(std::size_t group, int level, const Range& range);
  Range gather(List& list) const;
  void trace_misses(const Batch& batch, int level);
  void resolve_duplicates(const Batch& batch, std::size_t group, int level);
  void add_residual(const Batch& batch);

  std::shared_ptr<CacheCore> core_;
  SlotTable table_;
  CacheSalt salt_;
  BatchKeys keys_;
  QueryTracer tracer_;
  MissSet seen_;
  LookUpResult result_, again_;
  List next_, duplicates_;
  AlignedVector<std::uint32_t> which_, owner_;
  AlignedVector<std::uint8_t> mark_;  ///< of each query, for the residual: traced by itself, or answered where neighbours disagreed
};

}  // namespace sightline
