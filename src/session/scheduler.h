// What to render next, as pure logic: state and clock in, next piece of work out.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "film/frame.h"

namespace sightline {

enum class StopReason { none, samples, target_error, time_limit, interrupted };
std::string_view name_of(StopReason reason);

struct ScheduleLimits {
  SampleRange samples;                 ///< what is to be rendered; begins at a multiple of `multiple`
  std::optional<double> target_error;  ///< relative
  std::optional<double> time_limit_s;  ///< of the whole run, counted from its start
  std::uint32_t multiple = 1;          ///< passes begin at multiples of it
};

struct ScheduleState {
  std::uint32_t next_sample = 0;  ///< first sample index not yet done
  double elapsed_s = 0;           ///< since the start of the run (loading included)
  double seconds_per_sample = 0;  ///< of the passes so far, 0 = none yet
  std::optional<double> error;    ///< estimate of the frame so far
  bool interrupted = false;
};

struct ScheduledWork {
  StopReason stop = StopReason::none;  ///< none: render `pass` next
  SampleRange pass;
};

/// Pass sizes double from 1 while a pass stays under about a second, so that previews come early, overheads vanish, and limits are met
/// closely. Error estimates are looked at between passes.
ScheduledWork schedule(const ScheduleLimits& limits, const ScheduleState& state);

}  // namespace sightline
