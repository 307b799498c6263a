// One picture as a row of the results.
#pragma once

#include "bench/fragments/truth.h"

namespace sightline {

/// Fragments and rays by purpose, CPU seconds by stage, and errors; rays of Monte Carlo are counted as `rays` alone.
nlohmann::ordered_json fragment_row(const FragmentTruth& truth, const Shot& shot);

}  // namespace sightline
