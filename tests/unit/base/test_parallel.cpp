#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include "base/core/error.h"
#include "base/parallel/parallel.h"

namespace sightline {
namespace {

Context context_with(int threads) { return Context{.threads = threads, .memory_budget_bytes = 0, .seed = 0, .log = {}, .progress = {}}; }

class ParallelFor : public testing::TestWithParam<int> {
 protected:
  void SetUp() override { context_.threads = GetParam(); }
  Context context_;
};
INSTANTIATE_TEST_SUITE_P(Threads, ParallelFor, testing::Values(1, 2, 7));

TEST_P(ParallelFor, CoversEveryIndexOnce) {
  for (const std::size_t count : {0u, 1u, 5u, 64u, 1000u, 100003u}) {
    for (const std::size_t grain : {1u, 7u, 64u, 1000000u}) {
      if (count / grain > 20000) continue;
      std::vector<std::atomic<int>> visits(count);
      parallel_for(context_, count, grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) ++visits[i];
      });
      for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(visits[i], 1) << i << " of " << count << " by " << grain;
    }
  }
}

TEST_P(ParallelFor, ChunkBordersAreMultiplesOfTheGrain) {
  constexpr std::size_t kCount = 1000, kGrain = 64;
  std::mutex mutex;
  std::set<std::pair<std::size_t, std::size_t>> chunks;
  parallel_for(context_, kCount, kGrain, [&](std::size_t begin, std::size_t end) {
    const std::lock_guard lock(mutex);
    chunks.emplace(begin, end);
  });
  ASSERT_EQ(chunks.size(), (kCount + kGrain - 1) / kGrain);
  for (const auto& [begin, end] : chunks) {
    EXPECT_EQ(begin % kGrain, 0u);
    EXPECT_EQ(end, std::min(kCount, begin + kGrain));
  }
}

TEST_P(ParallelFor, AnArenaDoesWhatItIsGiven) {
  std::atomic<int> visits{0};
  run_in_arena(context_, [&] { parallel_for(context_, 100, 1, [&](std::size_t, std::size_t) { ++visits; }); });
  EXPECT_EQ(visits, 100);
  EXPECT_THROW(run_in_arena(context_, [] { throw std::runtime_error("from within"); }), std::runtime_error);
}

TEST_P(ParallelFor, ZeroGrainIsOne) {
  std::atomic<int> calls{0};
  parallel_for(context_, 5, 0, [&](std::size_t, std::size_t) { ++calls; });
  EXPECT_EQ(calls, 5);
}

TEST_P(ParallelFor, RethrowsAnExceptionOfItsBody) {
  EXPECT_THROW(parallel_for(context_, 100, 1,
                            [](std::size_t begin, std::size_t) {
                              if (begin == 42) throw std::out_of_range("42");
                            }),
               std::out_of_range);
  // And the pool is usable afterwards.
  std::atomic<int> calls{0};
  parallel_for(context_, 10, 1, [&](std::size_t, std::size_t) { ++calls; });
  EXPECT_EQ(calls, 10);
}

TEST_P(ParallelFor, SkipsChunksAfterAnException) {
  std::atomic<int> calls{0};
  EXPECT_THROW(parallel_for(context_, 1000000, 1,
                            [&](std::size_t, std::size_t) {
                              ++calls;
                              throw input_error("at once");
                            }),
               Error);
  EXPECT_LE(calls, GetParam());
}

TEST_P(ParallelFor, StopsWhenCancelled) {
  std::atomic<int> calls{0};
  try {
    parallel_for(context_, 1000000, 1, [&](std::size_t, std::size_t) {
      ++calls;
      context_.cancelled = true;
    });
    FAIL() << "cancelled";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::interrupted);
  }
  EXPECT_LE(calls, GetParam());
}

// Each body waits until as many threads as asked for have arrived, so this passes only if they exist, on however few cores.
TEST_P(ParallelFor, RunsOnAsManyDistinctThreadsAsAskedFor) {
  const auto wanted = static_cast<std::size_t>(GetParam());
  std::mutex mutex;
  std::condition_variable all_here;
  std::set<std::thread::id> ids;
  std::set<int> workers;
  parallel_for(context_, wanted, 1, [&](std::size_t, std::size_t) {
    std::unique_lock lock(mutex);
    ids.insert(std::this_thread::get_id());
    workers.insert(worker_index());
    all_here.notify_all();
    all_here.wait_for(lock, std::chrono::seconds(5), [&] { return ids.size() == wanted; });
  });
  EXPECT_EQ(ids.size(), wanted);
  EXPECT_EQ(workers.size(), wanted);
}

TEST_P(ParallelFor, WorkerIndicesAreBelowTheThreadCountAndNeverSharedAtOnce) {
  std::vector<std::atomic<int>> inside(static_cast<std::size_t>(GetParam()));
  std::atomic<bool> shared{false}, outside{false};
  parallel_for(context_, 2000, 1, [&](std::size_t, std::size_t) {
    const int worker = worker_index();
    if (worker < 0 || worker >= GetParam()) {
      outside = true;
      return;
    }
    std::atomic<int>& count = inside[static_cast<std::size_t>(worker)];
    if (++count != 1) shared = true;
    std::this_thread::yield();
    --count;
  });
  EXPECT_FALSE(outside);
  EXPECT_FALSE(shared);
  EXPECT_EQ(worker_index(), 0);
}

TEST_P(ParallelFor, LoopsMayBeNested) {
  std::atomic<int> calls{0};
  parallel_for(context_, 8, 1, [&](std::size_t, std::size_t) {
    parallel_for(context_, 16, 4, [&](std::size_t begin, std::size_t end) { calls += static_cast<int>(end - begin); });
  });
  EXPECT_EQ(calls, 8 * 16);
}

TEST(ParallelForAfterAnother, FewerThreadsAreKeptToAfterMore) {
  const Context many = context_with(7), two = context_with(2);
  parallel_for(many, 100, 1, [](std::size_t, std::size_t) {});
  std::mutex mutex;
  std::set<std::thread::id> ids;
  parallel_for(two, 400, 1, [&](std::size_t, std::size_t) {
    const std::lock_guard lock(mutex);
    ids.insert(std::this_thread::get_id());
    EXPECT_LT(worker_index(), 2);
  });
  EXPECT_LE(ids.size(), 3u);
}

}  // namespace
}  // namespace sightline
