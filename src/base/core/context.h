// What every long-running call of the library is given instead of global state.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace sightline {

enum class LogLevel { debug, info, warning, error };

/// Receives messages; called from any thread, one call at a time is not guaranteed. An empty function drops them.
using LogSink = std::function<void(LogLevel, std::string_view)>;

/// Progress of one phase: `done` of `total` work units (total 0: unknown).
struct Progress {
  std::string_view phase;
  double done = 0, total = 0;
};
/// Receives progress; may be called from any thread, often; it must be cheap and not throw.
using ProgressSink = std::function<void(const Progress&)>;

/// Threads, log, cancellation and memory budget, passed into load, build, prepare and render. Shared by reference; `cancelled` may be set
/// from another thread or a signal handler, everything else is fixed while a call runs.
struct Context {
  int threads = 0;                        ///< worker threads; 0 = all that affinity and cgroup allow (resolved by thread_count())
  std::uint64_t memory_budget_bytes = 0;  ///< 0 = no limit
  std::uint64_t seed = 0;
  LogSink log;
  ProgressSink progress;
  std::atomic<bool> cancelled{false};

  void info(std::string_view text) const { say(LogLevel::info, text); }
  void warn(std::string_view text) const { say(LogLevel::warning, text); }
  void debug(std::string_view text) const { say(LogLevel::debug, text); }
  void say(LogLevel level, std::string_view text) const {
    if (log) log(level, text);
  }
  void report(std::string_view phase, double done, double total) const {
    if (progress) progress({phase, done, total});
  }
  /// Throws Error{interrupted} once cancelled; called between units of work.
  void check_cancelled() const;
  /// Number of worker threads that parallel calls use.
  int thread_count() const;
};

/// Number of CPUs this process may use: the least of affinity mask and cgroup quota, at least 1.
int usable_cpu_count();
/// Peak resident set of this process in bytes (0 where the system does not tell).
std::uint64_t peak_resident_bytes();
/// Resident set now in bytes.
std::uint64_t current_resident_bytes();

}  // namespace sightline
