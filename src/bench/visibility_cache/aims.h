// What the visibility cache is meant to reach, beside what was measured.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace sightline {

/// One object for each aim that the results of run_cache_bench have a figure for: "figure", "measured", "aim", "at_most" (else at least),
/// "percent" (how it is shown), "met".
nlohmann::ordered_json cache_bench_aims(const nlohmann::ordered_json& results);

}  // namespace sightline
