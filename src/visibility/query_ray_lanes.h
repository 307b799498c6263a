// Shadow rays of queries, 16 at a time.
#pragma once

#include <cstddef>

#include "visibility/query_batch.h"

namespace sightline {

/// Rays of queries which[0 .. count) (null: first + [0, count)) to lanes [0, count) of `rays`, which has room for padded(count). The same
/// bits as query_ray().
void query_rays(const QueryBatch& queries, const std::uint32_t* which, std::size_t first, std::size_t count, RayBatch& rays);

}  // namespace sightline
