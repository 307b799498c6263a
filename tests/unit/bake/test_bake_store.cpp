#include <atomic>
#include <cstdlib>
#include <mutex>
#include <thread>

#include "bake/bake_store.h"
#include "bake_support.h"

namespace sightline::test {
namespace {

using What = BakeStore::Event::What;

/// Counts how often a bake is made, and keeps warnings.
struct Kitchen {
  Context context;
  std::atomic<int> made{0};
  std::mutex mutex;
  std::vector<std::string> warnings;
  Kitchen() {
    context.log = [this](LogLevel level, std::string_view text) {
      const std::lock_guard lock(mutex);
      if (level == LogLevel::warning) warnings.emplace_back(text);
    };
  }
  BakeStore::Maker maker() {
    return [this](const auto& keep) {
      ++made;
      const SmallBake small;
      keep(small.sections());
    };
  }
  std::shared_ptr<const BakeView> get(BakeStore& store, const BakeId& id = kSmallId) { return store.get(id, context, maker()); }
};

TEST(BakeStore, MakesOnceAndFindsAgain) {
  const Folder folder("store");
  Kitchen kitchen;
  {
    BakeStore store(folder.path() / "deep" / "er");
    const auto first = kitchen.get(store);
    EXPECT_EQ(kitchen.get(store), first);
    EXPECT_EQ(kitchen.made, 1);
    ASSERT_EQ(store.events().size(), 1u);
    EXPECT_EQ(store.events()[0].what, What::made);
    EXPECT_EQ(store.open_bytes(), first->bytes());
    EXPECT_TRUE(std::filesystem::exists(store.path_of(kSmallId)));
  }
  BakeStore store(folder.path() / "deep" / "er");
  EXPECT_EQ(kitchen.get(store)->array<float>("weights")[2], 2.5f);
  EXPECT_EQ(kitchen.made, 1);
  EXPECT_EQ(store.events()[0].what, What::found);
  EXPECT_TRUE(kitchen.warnings.empty());
}

TEST(BakeStore, RebuildsDamagedStaleAndForeignFilesWithAReason) {
  const Folder folder("rebuild");
  const auto spoil = [&](const std::function<void(const std::filesystem::path&)>& change, const std::string& reason) {
    Kitchen kitchen;
    BakeStore(folder.path()).get(kSmallId, kitchen.context, kitchen.maker());
    change(BakeStore(folder.path()).path_of(kSmallId));
    BakeStore store(folder.path());
    kitchen.made = 0;
    EXPECT_EQ(kitchen.get(store)->id(), kSmallId);
    EXPECT_EQ(kitchen.made, 1) << reason;
    ASSERT_EQ(store.events().size(), 1u);
    EXPECT_EQ(store.events()[0].what, What::rebuilt);
    EXPECT_NE(store.events()[0].reason.find(reason), std::string::npos) << store.events()[0].reason;
    ASSERT_EQ(kitchen.warnings.size(), 1u);
    EXPECT_NE(kitchen.warnings[0].find(reason), std::string::npos) << kitchen.warnings[0];
    BakeStore again(folder.path());
    kitchen.get(again);
    EXPECT_EQ(again.events()[0].what, What::found) << "the bad file was replaced";
  };
  const auto edit = [](const std::filesystem::path& path, auto&& change) {
    std::vector<char> bytes = bytes_of(path);
    change(bytes);
    write_bytes(path, bytes);
  };
  spoil([&](const auto& path) { edit(path, [](auto& bytes) { bytes[1000] ^= 4; }); }, "damaged");
  spoil([&](const auto& path) { edit(path, [](auto& bytes) { bytes.resize(bytes.size() / 2); }); }, "cut short");
  spoil([&](const auto& path) { edit(path, [](auto& bytes) { bytes = {'h', 'e', 'l', 'l', 'o'}; }); }, "not a bake");
  spoil([&](const auto& path) { write_bake(path, {kSmallId.kind, 2, kSmallId.key}, SmallBake().sections()); }, "stale: version 2");
  spoil([&](const auto& path) { write_bake(path, {kSmallId.kind, 3, {7, 7}}, SmallBake().sections()); }, "other data");
  spoil([&](const auto& path) { write_bake(path, {"test.other", 3, kSmallId.key}, SmallBake().sections()); }, "not of 'test.small'");
}

TEST(BakeStore, KeepsBakesInMemoryWithoutAFolder) {
  Kitchen kitchen;
  BakeStore store;
  EXPECT_EQ(kitchen.get(store), kitchen.get(store));
  EXPECT_EQ(kitchen.made, 1);
  EXPECT_TRUE(kitchen.warnings.empty());
  EXPECT_TRUE(store.path_of(kSmallId).empty());
}

TEST(BakeStore, KeepsBakesInMemoryWhereTheFolderCannotBe) {
  const Folder folder("unwritable");
  write_bytes(folder / "file", {'x'});
  Kitchen kitchen;
  BakeStore store(folder / "file" / "bakes");
  EXPECT_EQ(kitchen.get(store)->array<std::int8_t>("codes")[0], -5);
  EXPECT_EQ(kitchen.get(store)->id(), kSmallId);
  EXPECT_EQ(kitchen.made, 1);
  ASSERT_EQ(kitchen.warnings.size(), 1u);
  EXPECT_NE(kitchen.warnings[0].find("memory only"), std::string::npos);
}

TEST(BakeStore, LeavesNothingBehindWhereMakingFails) {
  const Folder folder("fails");
  Kitchen kitchen;
  BakeStore store(folder.path());
  const BakeStore::Maker interrupted = [](const auto&) { throw Error(ErrorCode::interrupted, "stopped"); };
  message_of(ErrorCode::interrupted, [&] { store.get(kSmallId, kitchen.context, interrupted); });
  message_of(ErrorCode::bug, [&] { store.get(kSmallId, kitchen.context, [](const auto&) {}); });
  EXPECT_EQ(folder.file_count(), 0u);
  EXPECT_TRUE(store.events().empty());
  EXPECT_EQ(kitchen.get(store)->id(), kSmallId);
}

TEST(BakeStore, GivesManyThreadsTheSameBake) {
  const Folder folder("threads");
  Kitchen kitchen;
  BakeStore store(folder.path());
  std::vector<std::shared_ptr<const BakeView>> got(8);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < got.size(); ++i) threads.emplace_back([&, i] { got[i] = kitchen.get(store); });
  for (std::thread& thread : threads) thread.join();
  for (const auto& bake : got) EXPECT_EQ(bake, got[0]);
  EXPECT_EQ(folder.file_count(), 1u);
  EXPECT_TRUE(kitchen.warnings.empty());
}

TEST(BakeStore, KeepsKindsKeysAndVersionsApart) {
  const Folder folder("apart");
  Kitchen kitchen;
  BakeStore store(folder.path());
  for (const BakeId& id :
       {kSmallId, BakeId{"test.other", 3, kSmallId.key}, BakeId{"test.small", 3, {1, 1}}, BakeId{"test.small", 4, {1, 1}}})
    EXPECT_EQ(kitchen.get(store, id)->id(), id);
  EXPECT_EQ(kitchen.made, 4);
}

TEST(DefaultBakeDirectory, FollowsTheCacheDirectory) {
  const char* const before = std::getenv("XDG_CACHE_HOME");
  const std::string saved = before ? before : "";
  setenv("XDG_CACHE_HOME", "/some/cache", 1);
  EXPECT_EQ(default_bake_directory(), "/some/cache/sightline/bakes");
  setenv("XDG_CACHE_HOME", "relative", 1);
  EXPECT_NE(default_bake_directory(), "relative/sightline/bakes");
  before ? setenv("XDG_CACHE_HOME", saved.c_str(), 1) : unsetenv("XDG_CACHE_HOME");
}

TEST(BakeStore, ClosesWhatHasAFileAndKeepsWhatHasNone) {
  const Folder folder("close");
  Kitchen kitchen;
  BakeStore on_disk(folder.path()), in_memory;
  for (BakeStore* store : {&on_disk, &in_memory}) {
    const auto held = kitchen.get(*store);
    store->close(kSmallId);
    EXPECT_EQ(store->open_bytes(), store == &on_disk ? 0 : held->bytes());
    EXPECT_EQ(held->array<float>("weights")[2], 2.5f);
    EXPECT_EQ(kitchen.get(*store)->array<float>("weights")[2], 2.5f);
  }
  EXPECT_EQ(kitchen.made, 2);
}

struct Weighed {
  std::uint64_t size;
  std::uint64_t bytes() const { return size; }
};

TEST(RecentValues, AreMadeOnceUntilOthersTakeTheirPlace) {
  RecentValues values(100);
  int made = 0;
  const auto get = [&](std::uint64_t key, std::uint64_t size = 40) {
    return values.get<Weighed>({"weighed", 1, {0, key}}, [&] { return ++made, Weighed{size}; });
  };
  const auto first = get(1);
  EXPECT_EQ(get(1), first);
  EXPECT_EQ(made, 1);
  get(2), get(1), get(3);  // the second was used least recently
  EXPECT_EQ(values.bytes(), 80u);
  EXPECT_EQ(get(1), first);
  EXPECT_EQ(made, 3);
  get(2);
  EXPECT_EQ(made, 4);
  // One that is larger than all there is room for is kept alone.
  get(4, 1000);
  EXPECT_EQ(values.bytes(), 1000u);
  get(4, 1000);
  EXPECT_EQ(made, 5);
}

}  // namespace
}  // namespace sightline::test
