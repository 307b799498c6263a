#include "trace/embree/build_arena.h"

#if SIGHTLINE_PARALLEL_TBB
#include <tbb/task_arena.h>
#endif

namespace sightline {

#if SIGHTLINE_PARALLEL_TBB
void run_in_build_arena(const Context& context, const std::function<void()>& build) {
  tbb::task_arena arena(context.thread_count());
  arena.execute(build);
}
const char* embree_thread_setting() { return ""; }
#else
void run_in_build_arena(const Context&, const std::function<void()>& build) { build(); }
const char* embree_thread_setting() { return ",threads=1"; }
#endif

}  // namespace sightline
