// std::thread backend of parallel_for: for ThreadSanitizer, which reports false races inside TBB.
#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "base/core/error.h"
#include "base/parallel/parallel.h"

namespace sightline {
namespace {
thread_local int current_worker = 0;
}

void parallel_for(const Context& context, std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body) {
  if (count == 0) return;
  grain = std::max<std::size_t>(grain, 1);
  const std::size_t chunk_count = (count + grain - 1) / grain;
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex failure_mutex;
  const auto work = [&](int index) {
    const int outer = std::exchange(current_worker, index);
    try {
      for (std::size_t chunk; (chunk = next.fetch_add(1, std::memory_order_relaxed)) < chunk_count;) {
        context.check_cancelled();
        body(chunk * grain, std::min(count, (chunk + 1) * grain));
      }
    } catch (...) {
      next.store(chunk_count, std::memory_order_relaxed);
      const std::lock_guard lock(failure_mutex);
      if (!failure) failure = std::current_exception();
    }
    current_worker = outer;
  };
  const int threads = static_cast<int>(std::min<std::size_t>(static_cast<std::size_t>(context.thread_count()), chunk_count));
  std::vector<std::jthread> others;
  for (int i = 1; i < threads; ++i) others.emplace_back(work, i);
  work(0);
  others.clear();
  if (failure) std::rethrow_exception(failure);
}

// No library shares these threads.
void run_in_arena(const Context&, const std::function<void()>& work) { work(); }

int worker_index() { return current_worker; }

}  // namespace sightline
