#include "session/scheduler.h"

#include <algorithm>
#include <cmath>

namespace sightline {
namespace {
constexpr double kPassSeconds = 1.0;
constexpr std::uint32_t kLargestPass = 64;
}  // namespace

std::string_view name_of(StopReason reason) {
  switch (reason) {
    case StopReason::none:
      return "none";
    case StopReason::samples:
      return "samples";
    case StopReason::target_error:
      return "target-error";
    case StopReason::time_limit:
      return "time-limit";
    case StopReason::interrupted:
      return "interrupted";
  }
  return "";
}

ScheduledWork schedule(const ScheduleLimits& limits, const ScheduleState& state) {
  if (state.interrupted) return {StopReason::interrupted, {}};
  if (state.next_sample >= limits.samples.end) return {StopReason::samples, {}};
  const std::uint32_t done = state.next_sample - limits.samples.begin;
  // The estimate of very few samples is itself too noisy to stop on.
  if (limits.target_error && done >= 4 && state.error && *state.error <= *limits.target_error) return {StopReason::target_error, {}};

  std::uint32_t size = std::clamp<std::uint32_t>(done, 1, kLargestPass);
  if (state.seconds_per_sample > 0) {
    const double affordable = kPassSeconds / state.seconds_per_sample;
    size = std::min(size, static_cast<std::uint32_t>(std::max(1.0, std::min(affordable, 1e9))));
  }
  if (limits.time_limit_s) {
    const double left = *limits.time_limit_s - state.elapsed_s;
    // The first pass always runs: a picture with one sample beats none. Later ones only if they fit.
    if (done > 0 && (left <= 0 || left < state.seconds_per_sample)) return {StopReason::time_limit, {}};
    if (state.seconds_per_sample > 0)
      size = std::min(size, static_cast<std::uint32_t>(std::clamp(left / state.seconds_per_sample, 1.0, 1e9)));
  }
  size = (size + limits.multiple - 1) / limits.multiple * limits.multiple;
  return {StopReason::none, {state.next_sample, std::min(limits.samples.end, state.next_sample + size)}};
}

}  // namespace sightline
