#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <cstring>
#include <random>

#include "bake/bake_description.h"
#include "bake_support.h"

namespace sightline::test {
namespace {

void expect_small(const BakeView& view) {
  const SmallBake small;
  EXPECT_EQ(view.id(), kSmallId);
  EXPECT_EQ(view.section_names(), (std::vector<std::string>{"weights", "codes", "nothing"}));
  const auto weights = view.array<float>("weights");
  ASSERT_EQ(weights.size(), small.weights.size());
  EXPECT_TRUE(std::equal(weights.begin(), weights.end(), small.weights.begin()));
  const auto codes = view.array<std::int8_t>("codes");
  ASSERT_EQ(codes.size(), small.codes.size());
  EXPECT_TRUE(std::equal(codes.begin(), codes.end(), small.codes.begin()));
  EXPECT_TRUE(view.array<std::uint16_t>("nothing").empty());
  EXPECT_TRUE(view.section("absent").empty());
  for (const std::string& name : view.section_names()) {
    const auto section = view.section(name);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(section.data()) % 64, 0u) << name;
    // Vectors may read 64 bytes past the end.
    for (std::size_t i = 0; i < 64; ++i) EXPECT_EQ(*(section.data() + section.size() + i), std::byte{0}) << name;
  }
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(BakeFile, HoldsWhatWasWrittenOnDiskAndInMemory) {
  const Folder folder("file");
  write_bake(folder / "a.bake", kSmallId, SmallBake().sections());
  expect_small(*open_bake(folder / "a.bake"));
  expect_small(*open_bake(folder / "a.bake", kSmallId));
  expect_small(*bake_in_memory(kSmallId, SmallBake().sections()));
  EXPECT_EQ(open_bake(folder / "a.bake")->bytes(), bytes_of(folder / "a.bake").size());
  EXPECT_EQ(folder.file_count(), 1u) << "the part file is gone";
}

TEST(BakeFile, IsTheSameFileEachTime) {
  const Folder folder("same");
  write_bake(folder / "a.bake", kSmallId, SmallBake().sections());
  write_bake(folder / "b.bake", kSmallId, SmallBake().sections());
  EXPECT_EQ(bytes_of(folder / "a.bake"), bytes_of(folder / "b.bake"));
}

TEST(BakeFile, HoldsNoSectionsToo) {
  const Folder folder("none");
  write_bake(folder / "a.bake", kSmallId, {});
  EXPECT_TRUE(open_bake(folder / "a.bake", kSmallId)->section_names().empty());
}

TEST(BakeFile, SaysWhatItIsOfWhenItIsOfSomethingElse) {
  const Folder folder("else");
  write_bake(folder / "a.bake", kSmallId, SmallBake().sections());
  const auto message = [&](BakeId id) { return message_of(ErrorCode::input, [&] { open_bake(folder / "a.bake", id); }); };
  EXPECT_TRUE(contains(message({"test.other", 3, kSmallId.key}), "a bake of 'test.small', not of 'test.other'"));
  EXPECT_TRUE(contains(message({"test.small", 4, kSmallId.key}), "stale: version 3"));
  EXPECT_TRUE(contains(message({"test.small", 3, {1, 2}}), "stale: made from other data"));
  EXPECT_TRUE(contains(message({"test.small", 3, {1, 2}}), (folder / "a.bake").string()));
}

TEST(BakeFile, RejectsWhatIsNoBake) {
  const Folder folder("foreign");
  const auto message = [&](const std::string& name) { return message_of(ErrorCode::input, [&] { open_bake(folder / name); }); };
  EXPECT_TRUE(contains(message("missing"), "cannot be read"));
  EXPECT_TRUE(contains(message(""), "not a file"));
  write_bytes(folder / "empty", {});
  EXPECT_TRUE(contains(message("empty"), "not a bake"));
  write_bytes(folder / "text", std::vector<char>(5000, 'x'));
  EXPECT_TRUE(contains(message("text"), "not a bake"));
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_TRUE(contains(message("pipe"), "not a file"));
}

TEST(BakeFile, RejectsEveryTruncation) {
  const Folder folder("short");
  write_bake(folder / "a.bake", kSmallId, SmallBake().sections());
  const std::vector<char> whole = bytes_of(folder / "a.bake");
  for (std::size_t size = 1; size < whole.size(); size += size < 24 ? 1 : 61) {
    write_bytes(folder / "b.bake", {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});
    const std::string message = message_of(ErrorCode::input, [&] { open_bake(folder / "b.bake"); });
    EXPECT_TRUE(contains(message, "cut short")) << size << ": " << message;
  }
  std::vector<char> longer = whole;
  longer.resize(whole.size() + 64);
  write_bytes(folder / "b.bake", longer);
  EXPECT_TRUE(contains(message_of(ErrorCode::input, [&] { open_bake(folder / "b.bake"); }), "longer"));
}

TEST(BakeFile, RejectsEveryChangedByteButOfPadding) {
  const Folder folder("damage");
  write_bake(folder / "a.bake", kSmallId, SmallBake().sections());
  const std::vector<char> whole = bytes_of(folder / "a.bake");
  std::mt19937 random(1);
  const std::size_t header = 128 + 3 * 64;
  // Every byte of the header, and some of each section.
  for (std::size_t i = 0; i < header + 4000; i += i < header ? 3 : 97) {
    std::vector<char> changed = whole;
    changed[i] = static_cast<char>(changed[i] ^ static_cast<char>(1u << (random() % 8)));
    write_bytes(folder / "b.bake", changed);
    message_of(ErrorCode::input, [&] { open_bake(folder / "b.bake"); });
  }
  std::vector<char> changed = whole;
  changed[header + 4000 + 96 + 10] ^= 1;  // the second section, after 64 + 32 bytes of padding
  write_bytes(folder / "b.bake", changed);
  EXPECT_TRUE(contains(message_of(ErrorCode::input, [&] { open_bake(folder / "b.bake"); }), "section 'codes'"));
}

TEST(BakeFile, KeepsTheOldFileWhereTheNewOneDoesNotFit) {
  const Folder folder("full");
  write_bake(folder / "a.bake", kSmallId, SmallBake().sections());
  const std::vector<char> before = bytes_of(folder / "a.bake");
  const std::vector<float> big(100000, 1.f);
  const BakeSection section = bake_section("big", std::span<const float>(big));

  // A limit on the size of files ends a write like a full disk does.
  struct rlimit saved{}, small{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &saved), 0);
  small = saved;
  small.rlim_cur = 100000;
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string message = message_of(ErrorCode::resource, [&] { write_bake(folder / "a.bake", kSmallId, {&section, 1}); });
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &saved), 0);
  std::signal(SIGXFSZ, handler);
  EXPECT_TRUE(contains(message, "cannot be written")) << message;
  EXPECT_EQ(bytes_of(folder / "a.bake"), before);
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST(BakeFile, CannotBeWrittenWhereThereIsNoFolder) {
  const Folder folder("nowhere");
  message_of(ErrorCode::resource, [&] { write_bake(folder / "no" / "a.bake", kSmallId, SmallBake().sections()); });
  EXPECT_EQ(folder.file_count(), 0u);
}

TEST(BakeFile, RefusesNamesThatNoFileCanHold) {
  const SmallBake small;
  const auto refused = [](const BakeId& id, std::vector<BakeSection> sections) {
    message_of(ErrorCode::bug, [&] { bake_in_memory(id, sections); });
  };
  refused({"Upper", 1, {}}, {});
  refused({"", 1, {}}, {});
  refused({std::string(64, 'a'), 1, {}}, {});
  refused(kSmallId, {{std::string(32, 'a'), {}}});
  refused(kSmallId, {{"twice", {}}, {"twice", {}}});
  EXPECT_NO_THROW(bake_in_memory({std::string(63, 'a'), 1, {}}, std::vector<BakeSection>{{std::string(31, 'a'), {}}}));
}

TEST(BakeFile, ArraysAreRefusedInOtherTypes) {
  const auto view = bake_in_memory(kSmallId, SmallBake().sections());
  EXPECT_TRUE(contains(message_of(ErrorCode::input, [&] { view->array<float>("codes"); }), "no multiple of 4"));
  EXPECT_TRUE(contains(message_of(ErrorCode::input, [&] { view->array<float>("absent"); }), "no section 'absent'"));
}

TEST(BakeDescription, NamesKindSectionsAndDamage) {
  const Folder folder("describe");
  write_bake(folder / "a.bake", kSmallId, SmallBake().sections());
  std::vector<char> bytes = bytes_of(folder / "a.bake");
  EXPECT_TRUE(is_bake(std::as_bytes(std::span(bytes))));
  BakeDescription description = describe_bake(folder / "a.bake");
  EXPECT_EQ(description.id, kSmallId);
  EXPECT_EQ(description.bytes, bytes.size());
  ASSERT_EQ(description.sections.size(), 3u);
  EXPECT_EQ(description.sections[0].bytes, 4000u);
  EXPECT_TRUE(description.damage.empty());

  bytes[128 + 3 * 64 + 5] ^= 1;
  write_bytes(folder / "a.bake", bytes);
  description = describe_bake(folder / "a.bake");
  EXPECT_EQ(description.id, kSmallId) << "the header is whole";
  EXPECT_TRUE(description.sections[0].damaged);
  EXPECT_FALSE(description.sections[1].damaged);
  EXPECT_TRUE(contains(description.damage, "weights"));

  bytes.resize(200);
  write_bytes(folder / "a.bake", bytes);
  description = describe_bake(folder / "a.bake");
  EXPECT_TRUE(contains(description.damage, "cut short")) << description.damage;
  message_of(ErrorCode::input, [&] { describe_bake(folder / "absent"); });
}

TEST(BakeHash, DependsOnOrderSizesAndValues) {
  const auto key = [](auto&&... parts) {
    BakeHash hash;
    (hash.add(parts), ...);
    return hash.key();
  };
  const std::vector<float> one{1, 2}, two{3};
  const auto spans = [&](std::span<const float> a, std::span<const float> b) {
    BakeHash hash;
    hash.add(a).add(b);
    return hash.key();
  };
  EXPECT_EQ(key(1, 2.f, std::string_view("x")), key(1, 2.f, std::string_view("x")));
  EXPECT_NE(key(1, 2), key(2, 1));
  EXPECT_NE(key(std::string_view("ab"), std::string_view("c")), key(std::string_view("a"), std::string_view("bc")));
  EXPECT_NE(spans(one, two), spans(std::vector<float>{1}, std::vector<float>{2, 3}));
  EXPECT_EQ(BakeId{}.key_text(), std::string(32, '0'));
}

}  // namespace
}  // namespace sightline::test
