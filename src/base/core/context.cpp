#include "base/core/context.h"

#include <sched.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>

#include "base/core/error.h"

namespace sightline {
namespace {

// cgroup v2 writes "max 100000" or "200000 100000" (quota and period in µs).
int cgroup_cpu_limit() {
  std::ifstream file("/sys/fs/cgroup/cpu.max");
  std::string quota;
  double period = 0;
  if (!(file >> quota >> period) || quota == "max" || period <= 0) return 0;
  try {
    return std::max(1, static_cast<int>(std::lround(std::stod(quota) / period)));
  } catch (const std::exception&) {
    return 0;
  }
}

std::uint64_t status_kib(const char* key) {
  std::ifstream file("/proc/self/status");
  std::string word;
  while (file >> word) {
    if (word == key) {
      std::uint64_t kib = 0;
      file >> kib;
      return kib;
    }
  }
  return 0;
}

}  // namespace

int usable_cpu_count() {
  cpu_set_t set;
  CPU_ZERO(&set);
  int count = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
  if (const int limit = cgroup_cpu_limit(); limit > 0) count = std::min(count, limit);
  return std::max(1, count);
}

void Context::check_cancelled() const {
  if (cancelled.load(std::memory_order_relaxed)) throw Error(ErrorCode::interrupted, "cancelled");
}

int Context::thread_count() const { return threads > 0 ? threads : usable_cpu_count(); }

std::uint64_t peak_resident_bytes() { return status_kib("VmHWM:") * 1024; }
std::uint64_t current_resident_bytes() { return status_kib("VmRSS:") * 1024; }

}  // namespace sightline
