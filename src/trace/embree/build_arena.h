// Confines Embree's builders to a Context's threads.
#pragma once

#include <functional>

#include "base/core/context.h"

namespace sightline {

/// Runs `build` on context.thread_count() threads. Embree's own `threads=` setting would install a tbb::global_control that throttles the
/// whole process for as long as the device lives; a device that is made inside a task arena takes the arena's size instead.
void run_in_build_arena(const Context& context, const std::function<void()>& build);

/// Thread setting for rtcNewDevice: empty, or "threads=1" where parallel loops do not run on TBB (ThreadSanitizer).
const char* embree_thread_setting();

}  // namespace sightline
