// Parallel loops over indices. The only header through which the project uses threads for work.
#pragma once

#include <cstddef>
#include <functional>

#include "base/core/context.h"

namespace sightline {

/// Calls body(begin, end) on disjoint chunks of at most `grain` indices that cover [0, count), on context.thread_count() threads. Chunk
/// borders are multiples of `grain` whatever the number of threads, so per-chunk results do not depend on it. The first exception of a
/// body is rethrown here; chunks not yet started are then skipped. Stops with Error{interrupted} when the context is cancelled.
void parallel_for(const Context& context, std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t begin, std::size_t end)>& body);

/// Runs `work` where libraries that share the scheduler (Embree's builder) use context.thread_count() threads for loops of their own.
void run_in_arena(const Context& context, const std::function<void()>& work);

/// Index of the calling worker in [0, context.thread_count()) inside a parallel_for body, for per-thread scratch; 0 outside.
int worker_index();

}  // namespace sightline
