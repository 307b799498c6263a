// The visibility-cache benchmark's results as tables.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "bench/bench_tables.h"

namespace sightline {

/// Tables of one part of the results of run_cache_bench ("aims", "curves", "equal_time", "shadow_maps", "lookup", "flicker", "ablations");
/// empty where it has none.
std::vector<BenchTable> cache_bench_tables(const nlohmann::ordered_json& results, const std::string& part);

}  // namespace sightline
