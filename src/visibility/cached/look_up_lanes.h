// Look-ups of many queries at once: keys are combined, hashed and gathered, and queries are sorted out by what is to be done next.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/core/aligned.h"
#include "visibility/cached/key.h"
#include "visibility/cached/settings.h"

namespace sightline {

/// Queries of one level, ends by index.
struct LookUp {
  const std::uint32_t* eye = nullptr;
  const std::uint32_t* light = nullptr;  ///< kNoQuery: no query
  const std::uint32_t* id = nullptr;     ///< where its answer belongs; null: `first` + i
  std::uint32_t first = 0;
  std::size_t count = 0;

  const EndKeys* eye_keys = nullptr;
  const EndKeys* light_keys = nullptr;
  const std::uint32_t* table = nullptr;
  int table_bits = 18;
  CacheSalt salt;
  CacheHash hash = CacheHash::separable;
  CacheRefinement neighbours = CacheRefinement::none;  ///< none also on the last level
  bool last_level = true;                              ///< mixed cells are answered by their majority
  const float* importance = nullptr;                   ///< by query; null: all alike
  float most_important = 0;                            ///< queries above are not cached
  bool counters = false;                               ///< slots count rays by outcome (SlotFormat)
  std::uint32_t rays_a_cell = 1;                       ///< counters: until a cell that nothing contradicts is trusted
};

/// Queries by what is to be done next. Answered ones are in the weights.
struct LookUpResult {
  AlignedVector<std::uint32_t> miss_id, miss_index, miss_tag;  ///< not enough known
  AlignedVector<std::uint32_t> refine_id;                      ///< neighbours disagree
  AlignedVector<std::uint32_t> exact_id;                       ///< cannot be cached
  std::size_t misses = 0, refines = 0, exacts = 0;
  std::uint64_t asked = 0, answered = 0, lookups = 0, rejected = 0;

  void reserve(std::size_t count) {
    for (AlignedVector<std::uint32_t>* array : {&miss_id, &miss_index, &miss_tag, &refine_id, &exact_id}) {
      if (array->size() < count + 2 * kLanes) array->resize(count + 2 * kLanes);
    }
  }
};

/// `result` is overwritten. With ids null, weights [first, first + padded(count)) are written, gaps with 0; else only answered ones.
void look_up_lanes(const LookUp& queries, float* weights, LookUpResult& result);

/// Slots of keys in the three hashes, for tests: what look_up_lanes would gather.
void slot_lanes(const LookUp& queries, std::uint32_t* index, std::uint32_t* digest);

}  // namespace sightline
