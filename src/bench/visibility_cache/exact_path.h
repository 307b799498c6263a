// What exact visibility costs beside bare Embree.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "bench/visibility_cache/cache_view.h"

namespace sightline {

/// Some of the batches that the exact picture of the view asks, about `queries` queries, on one thread: answered by the exact visibility;
/// their rays, made beforehand, as the Tracer takes them; the same in bare calls of every style, in the order asked and, where eye points
/// share light ends, sorted by light. The fastest of these counts.
nlohmann::ordered_json measure_exact_path(const CacheView& view, std::uint64_t queries, const Context& context);

}  // namespace sightline
