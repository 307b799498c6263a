#include <gtest/gtest.h>
#include <sched.h>

#include <string>
#include <vector>

#include "base/core/context.h"
#include "base/core/error.h"

namespace sightline {
namespace {

TEST(Context, SaysNothingWithoutSinks) {
  const Context context;
  context.warn("nobody listens");
  context.report("phase", 1, 2);
}

TEST(Context, PassesLevelAndTextToItsSink) {
  Context context;
  std::vector<std::pair<LogLevel, std::string>> heard;
  context.log = [&](LogLevel level, std::string_view text) { heard.emplace_back(level, text); };
  context.info("a");
  context.warn("b");
  context.debug("c");
  ASSERT_EQ(heard.size(), 3u);
  EXPECT_EQ(heard[0], std::pair(LogLevel::info, std::string("a")));
  EXPECT_EQ(heard[1], std::pair(LogLevel::warning, std::string("b")));
  EXPECT_EQ(heard[2], std::pair(LogLevel::debug, std::string("c")));
}

TEST(Context, PassesProgressToItsSink) {
  Context context;
  double fraction = 0;
  context.progress = [&](const Progress& progress) { fraction = progress.done / progress.total; };
  context.report("render", 3, 4);
  EXPECT_EQ(fraction, 0.75);
}

TEST(Context, ThrowsInterruptedOnceCancelled) {
  Context context;
  context.check_cancelled();
  context.cancelled = true;
  try {
    context.check_cancelled();
    FAIL() << "cancelled";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::interrupted);
  }
}

TEST(Context, TakesTheThreadsAskedForElseAllUsable) {
  Context context;
  EXPECT_EQ(context.thread_count(), usable_cpu_count());
  context.threads = 7;
  EXPECT_EQ(context.thread_count(), 7);
}

TEST(Context, UsableCpusFollowTheAffinityMask) {
  cpu_set_t before;
  ASSERT_EQ(sched_getaffinity(0, sizeof before, &before), 0);
  int first = 0;
  while (!CPU_ISSET(first, &before)) ++first;
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(first, &one);
  ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
  EXPECT_EQ(usable_cpu_count(), 1);
  ASSERT_EQ(sched_setaffinity(0, sizeof before, &before), 0);
}

TEST(Context, MemoryFiguresGrowWithMemoryThatIsTouched) {
  const std::uint64_t before = current_resident_bytes();
  std::vector<char> block(64 << 20, 1);
  EXPECT_GE(current_resident_bytes(), before + (60u << 20));
  EXPECT_GE(peak_resident_bytes(), current_resident_bytes());
  EXPECT_EQ(block[12345], 1);
}

}  // namespace
}  // namespace sightline
