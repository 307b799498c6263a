// What the square-lights method is meant to reach, beside what was measured.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace sightline {

/// Rows of aims over the results of run_square_bench; what was not measured has none.
nlohmann::ordered_json square_bench_aims(const nlohmann::ordered_json& results);

}  // namespace sightline
