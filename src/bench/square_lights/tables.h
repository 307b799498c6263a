// The square-lights benchmark's results as tables.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "bench/bench_tables.h"

namespace sightline {

/// Tables of one part of the results of run_square_bench, or of its "aims"; empty where it has none.
std::vector<BenchTable> square_bench_tables(const nlohmann::ordered_json& results, const std::string& part);

}  // namespace sightline
