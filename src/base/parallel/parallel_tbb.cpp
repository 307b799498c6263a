// oneTBB backend of parallel_for: shares its workers with Embree's builder.
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <mutex>

#include "base/core/error.h"
#include "base/parallel/parallel.h"

namespace sightline {
namespace {

// oneTBB starts no more workers than there are cores unless a global_control says so; of several living ones the smallest counts, so
// there is one, which grows to the largest number ever asked for. The arenas keep each loop to its own number. It comes before any arena
// that wants more: oneTBB prints a warning on stderr otherwise.
void allow_threads(std::size_t count) {
  static std::mutex mutex;
  static std::unique_ptr<tbb::global_control> control;
  using Control = tbb::global_control;
  const std::lock_guard lock(mutex);
  if (count <= Control::active_value(Control::max_allowed_parallelism)) return;
  control.reset();
  control = std::make_unique<Control>(Control::max_allowed_parallelism, count);
}

tbb::task_arena arena_of(int threads) {
  allow_threads(static_cast<std::size_t>(threads));
  return tbb::task_arena(threads);
}

}  // namespace

void parallel_for(const Context& context, std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body) {
  if (count == 0) return;
  grain = std::max<std::size_t>(grain, 1);
  const std::size_t chunk_count = (count + grain - 1) / grain;
  const auto run_chunk = [&](std::size_t chunk) {
    context.check_cancelled();
    body(chunk * grain, std::min(count, (chunk + 1) * grain));
  };
  const int threads = context.thread_count();
  if (threads == 1 || chunk_count == 1) {
    for (std::size_t chunk = 0; chunk < chunk_count; ++chunk) run_chunk(chunk);
    return;
  }
  // A shared counter hands chunks out in order: neighbouring chunks run at about the same time, which caches like, and long chunks at the
  // start do not wait behind a static split.
  tbb::task_arena arena = arena_of(threads);
  std::atomic<std::size_t> next{0};
  arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<int>(0, threads, 1),
        [&](const tbb::blocked_range<int>& range) {
          for (int i = range.begin(); i != range.end(); ++i) {
            try {
              for (std::size_t chunk; (chunk = next.fetch_add(1, std::memory_order_relaxed)) < chunk_count;) run_chunk(chunk);
            } catch (...) {
              next.store(chunk_count, std::memory_order_relaxed);
              throw;
            }
          }
        },
        tbb::simple_partitioner());
  });
}

void run_in_arena(const Context& context, const std::function<void()>& work) { arena_of(context.thread_count()).execute(work); }

int worker_index() { return std::max(0, tbb::this_task_arena::current_thread_index()); }

}  // namespace sightline
