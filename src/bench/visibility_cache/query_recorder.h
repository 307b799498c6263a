// The visibility queries of a picture, written down as a method asks them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/visibility_cache/cache_view.h"
#include "visibility/query_batch.h"

namespace sightline {

/// The batches of one scope (a tile), in order.
struct RecordedScope {
  std::uint32_t scope = 0;
  std::vector<QueryBatch> batches;
};

/// Some tiles of the view at one sample a pixel, spread over the picture, until about `queries` are collected. `visibility` and `settings`
/// decide the order in which the method asks.
std::vector<RecordedScope> record_queries(const CacheView& view, const std::string& visibility, const std::vector<std::string>& settings,
                                          std::uint64_t queries, const Context& context);

}  // namespace sightline
