// Hashes of structured keys behave like random numbers.
#include "visibility/cached/hash.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "visibility/cached/table.h"

namespace sightline::test {
namespace {

constexpr int kBits = 20;
constexpr CacheSalt kSalt{12345, 678};

class Hash : public testing::TestWithParam<CacheHash> {};
INSTANTIATE_TEST_SUITE_P(All, Hash, testing::Values(CacheHash::separable, CacheHash::recurrence, CacheHash::mix64), [](const auto& tested) {
  return std::string(tested.param == CacheHash::separable ? "separable" : tested.param == CacheHash::recurrence ? "recurrence" : "mix64");
});

// Neighbouring voxels of a floor times lights with cells side by side: 2^20 keys.
template <class Take>
void structured_keys(Take&& take) {
  for (std::uint32_t x = 0; x < 256; ++x) {
    for (std::uint32_t y = 0; y < 256; ++y) {
      for (std::uint32_t l = 0; l < 16; ++l) {
        const EndWords eye{4u | (8u << 6) | (4u << 12) | (30u << EndWords::kLevelShift), 100 + x, 200 + y, 555};
        const EndWords light{4u | (4u << 12) | (9u << EndWords::kLevelShift) | (2u << EndWords::kSemanticShift), 3 + l % 4, 5 + l / 4, 17};
        take(eye, light);
      }
    }
  }
}

TEST_P(Hash, DistinctKeysAreHardlyEverTakenForEachOther) {
  const SlotFormat format;
  std::vector<std::uint32_t> table(std::size_t{1} << kBits);
  int wrong = 0;
  structured_keys([&](const EndWords& eye, const EndWords& light) {
    const CacheSlot slot = cache_slot(GetParam(), eye, light, kSalt, kBits);
    const std::uint32_t tag = format.tag(slot.digest);
    wrong += format.matches(table[slot.index], tag);
    table[slot.index] = tag;
  });
  EXPECT_LE(wrong, 2);
}

TEST_P(Hash, SlotsAreFilledEvenly) {
  // The separable hash puts blocks of 4x4 cells into one cache line: there lines are what is drawn at random.
  const int unit_bits = GetParam() == CacheHash::separable ? 4 : 0;
  std::vector<int> counts((std::size_t{1} << kBits) >> unit_bits);
  std::size_t keys = 0;
  structured_keys([&](const EndWords& eye, const EndWords& light) {
    const CacheSlot slot = cache_slot(GetParam(), eye, light, kSalt, kBits);
    ASSERT_LT(slot.index, 1u << kBits);
    if (unit_bits != 0 && (slot.index & 15) != 0) return;
    ++counts[slot.index >> unit_bits], ++keys;
  });
  const double expected = static_cast<double>(keys) / static_cast<double>(counts.size());
  double chi = 0;
  for (const int n : counts) chi += (n - expected) * (n - expected) / expected;
  const double freedom = static_cast<double>(counts.size()) - 1;
  // Generators of the paper spread such keys more evenly than chance would: only more uneven counts as failure.
  EXPECT_LT(chi, freedom + 5 * std::sqrt(2 * freedom));
}

TEST_P(Hash, CellsOfABlockStayApart) {
  // All 16 cells of a block, times many: no two keys fall on one slot and digest.
  std::vector<std::uint64_t> seen;
  structured_keys([&](const EndWords& eye, const EndWords& light) {
    const CacheSlot slot = cache_slot(GetParam(), eye, light, kSalt, kBits);
    seen.push_back((static_cast<std::uint64_t>(slot.index) << 32) | (slot.digest & ~1u));
  });
  std::sort(seen.begin(), seen.end());
  EXPECT_EQ(std::adjacent_find(seen.begin(), seen.end()), seen.end());
}

TEST_P(Hash, EveryWordAndSaltMatters) {
  const EndWords eye{0x1234567, 10, 20, 30};
  const EndWords light{(3u | (3u << EndWords::kLevelShift) | (2u << EndWords::kSemanticShift)), 11, 21, 31};
  const CacheSlot base = cache_slot(GetParam(), eye, light, kSalt, kBits);
  const auto differs = [&](EndWords e, EndWords l, CacheSalt salt) {
    const CacheSlot other = cache_slot(GetParam(), e, l, salt, kBits);
    EXPECT_FALSE(other.index == base.index && other.digest == base.digest);
  };
  for (std::uint32_t EndWords::* word : {&EndWords::packed, &EndWords::x, &EndWords::y, &EndWords::z}) {
    EndWords changed = eye;
    ++(changed.*word);
    differs(changed, light, kSalt);
    changed = light;
    ++(changed.*word);
    differs(eye, changed, kSalt);
  }
  differs(eye, light, {kSalt.a + 1, kSalt.b});
  differs(eye, light, {kSalt.a, kSalt.b + 1});
}

TEST(MixPair, EveryBitChangesHalfOfAll) {
  std::mt19937 random(1);
  double worst = 0;
  for (int bit = 0; bit < 64; ++bit) {
    std::array<int, 64> flips{};
    constexpr int kCount = 4000;
    for (int n = 0; n < kCount; ++n) {
      const auto a = static_cast<std::uint32_t>(random()), b = static_cast<std::uint32_t>(random());
      std::uint32_t a0 = a, b0 = b, a1 = a ^ (bit < 32 ? 1u << bit : 0), b1 = b ^ (bit < 32 ? 0 : 1u << (bit - 32));
      mix_pair(a0, b0), mix_pair(a1, b1);
      for (int i = 0; i < 32; ++i) flips[i] += ((a0 ^ a1) >> i) & 1, flips[32 + i] += ((b0 ^ b1) >> i) & 1;
    }
    for (const int f : flips) worst = std::fmax(worst, std::fabs(f / double{kCount} - 0.5));
  }
  EXPECT_LT(worst, 0.15);
}

TEST(SlotFormat, CountersSaturateAndStartAnew) {
  const SlotFormat counters{true};
  const std::uint32_t tag = counters.tag(0xabcdef00u), other = counters.tag(0x12345600u);
  std::uint32_t slot = 0;
  for (int i = 0; i < 9; ++i) slot = counters.after(slot, tag, true);
  EXPECT_EQ(slot ^ tag, 7u * SlotFormat::kVisible);
  slot = counters.after(slot, tag, false);
  EXPECT_EQ(slot ^ tag, 7u * SlotFormat::kVisible + SlotFormat::kHidden);
  slot = counters.after(slot, other, false);
  EXPECT_EQ(slot ^ other, SlotFormat::kHidden);
  EXPECT_NE(SlotFormat{}.tag(0), 0u);
  EXPECT_NE(counters.tag(63), 0u);
}

TEST(SlotTable, ClearingLeavesNothing) {
  for (const std::size_t inserts : {std::size_t{3}, std::size_t{1000}}) {
    SlotTable table(10);
    for (std::uint32_t i = 0; i < inserts; ++i) table.insert((i * 77) & 1023, 2 * i + 2, true, {});
    table.clear();
    for (std::size_t i = 0; i < table.size(); ++i) ASSERT_EQ(table.data()[i], 0u);
  }
}

}  // namespace
}  // namespace sightline::test
