// What the fragments method is meant to reach, beside what was measured.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace sightline {

/// Rows of aims over the results of run_fragment_bench; what was not measured has none.
nlohmann::ordered_json fragment_bench_aims(const nlohmann::ordered_json& results);

}  // namespace sightline
