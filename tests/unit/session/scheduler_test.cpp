#include "session/scheduler.h"

#include <gtest/gtest.h>

namespace sightline {
namespace {

// Runs the schedule against a made-up clock on which a sample costs `cost` seconds; returns the number of samples and the reason.
std::pair<std::uint32_t, StopReason> simulate(const ScheduleLimits& limits, double cost, double start = 0) {
  ScheduleState state;
  state.next_sample = limits.samples.begin;
  state.elapsed_s = start;
  for (int pass = 0; pass < 100000; ++pass) {
    const ScheduledWork work = schedule(limits, state);
    if (work.stop != StopReason::none) return {state.next_sample - limits.samples.begin, work.stop};
    EXPECT_EQ(work.pass.begin, state.next_sample);
    EXPECT_GT(work.pass.end, work.pass.begin);
    EXPECT_LE(work.pass.end, limits.samples.end);
    state.elapsed_s += cost * work.pass.count();
    state.next_sample = work.pass.end;
    state.seconds_per_sample = cost;
    state.error = 1.0 / (state.next_sample - limits.samples.begin);
  }
  ADD_FAILURE() << "did not end";
  return {};
}

TEST(Scheduler, RendersAllSamplesOnce) {
  EXPECT_EQ(simulate({{0, 100}, {}, {}}, 0.01), std::pair(100u, StopReason::samples));
  EXPECT_EQ(simulate({{30, 37}, {}, {}}, 5), std::pair(7u, StopReason::samples));
}

TEST(Scheduler, PassesBeginAtMultiplesOfAGroup) {
  ScheduleLimits limits{{32, 100}, {}, {}, 16};
  ScheduleState state;
  state.next_sample = 32;
  for (const double cost : {0.0, 0.001, 0.3, 20.0}) {
    state.seconds_per_sample = cost;
    for (const std::uint32_t next : {32u, 48u, 96u}) {
      state.next_sample = next;
      const ScheduledWork work = schedule(limits, state);
      EXPECT_EQ(work.pass.begin, next);
      EXPECT_TRUE(work.pass.end == 100 || work.pass.end % 16 == 0) << work.pass.end;
      EXPECT_GT(work.pass.end, next);
    }
  }
}

TEST(Scheduler, StopsInTimeButNotBeforeThereIsAPicture) {
  const auto [samples, reason] = simulate({{0, 100000}, {}, 10.0}, 0.1);
  EXPECT_EQ(reason, StopReason::time_limit);
  EXPECT_GE(samples, 95u);
  EXPECT_LE(samples, 100u);
  EXPECT_EQ(simulate({{0, 100}, {}, 1.0}, 50), std::pair(1u, StopReason::time_limit));
  EXPECT_EQ(simulate({{0, 100}, {}, 1.0}, 0.1, 5), std::pair(1u, StopReason::time_limit));
}

TEST(Scheduler, StopsAtTheTargetError) {
  const auto [samples, reason] = simulate({{0, 100000}, 0.01, {}}, 1e-3);
  EXPECT_EQ(reason, StopReason::target_error);
  EXPECT_GE(samples, 100u);
  EXPECT_LE(samples, 200u);
}

TEST(Scheduler, InterruptionWins) {
  ScheduleState state;
  state.interrupted = true;
  EXPECT_EQ(schedule({{0, 10}, {}, {}}, state).stop, StopReason::interrupted);
}

TEST(Scheduler, PassesGrowWhileTheyAreShort) {
  ScheduleState state;
  state.next_sample = 8;
  state.seconds_per_sample = 1e-3;
  EXPECT_EQ(schedule({{0, 1000}, {}, {}}, state).pass.count(), 8u);
  state.seconds_per_sample = 2;
  EXPECT_EQ(schedule({{0, 1000}, {}, {}}, state).pass.count(), 1u);
}

}  // namespace
}  // namespace sightline
