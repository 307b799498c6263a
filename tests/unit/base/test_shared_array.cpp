#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <numeric>
#include <vector>

#include "base/core/aligned.h"
#include "base/core/shared_array.h"

namespace sightline {
namespace {

template <class T>
class SharedArrayOf : public testing::Test {};
struct Triple {
  float x, y, z;
};
using ElementTypes = testing::Types<std::uint8_t, std::uint16_t, float, Triple, std::array<double, 5>>;
TYPED_TEST_SUITE(SharedArrayOf, ElementTypes);

// Embree reads up to 16 bytes past the last vertex; AddressSanitizer would stop here if they were not ours.
TYPED_TEST(SharedArrayOf, HasSixteenReadableBytesAfterItsEnd) {
  for (const std::size_t size : {1u, 2u, 3u, 17u, 1000u}) {
    const auto array = SharedArray<TypeParam>::make(size, [](std::span<TypeParam> elements) {
      for (TypeParam& element : elements) std::memset(&element, 0xff, sizeof element);
    });
    ASSERT_EQ(array.size(), size);
    std::array<std::uint8_t, 16> after;
    std::memcpy(after.data(), reinterpret_cast<const std::uint8_t*>(array.data()) + array.size_bytes(), after.size());
    for (const std::uint8_t byte : after) EXPECT_EQ(byte, 0);
  }
}

TEST(SharedArray, CopiesShareMemoryAndAreEqual) {
  const SharedArray<int> original(std::vector<int>{1, 2, 3});
  const SharedArray<int> copy = original;
  EXPECT_EQ(copy.data(), original.data());
  EXPECT_TRUE(copy == original);
  // Same content in other memory is not known to be the same.
  EXPECT_FALSE(SharedArray<int>(std::vector<int>{1, 2, 3}) == original);
}

TEST(SharedArray, OutlivesTheArrayItWasCopiedFrom) {
  SharedArray<int> copy;
  {
    std::vector<int> values(1000);
    std::iota(values.begin(), values.end(), 0);
    const SharedArray<int> original(values);
    copy = original;
  }
  EXPECT_EQ(copy[999], 999);
  EXPECT_EQ(std::accumulate(copy.begin(), copy.end(), 0), 499500);
}

TEST(SharedArray, EmptyHoldsNothing) {
  const SharedArray<float> array = SharedArray<float>::make(0, [](std::span<float>) { FAIL() << "nothing to fill"; });
  EXPECT_TRUE(array.empty());
  EXPECT_EQ(array.span().size(), 0u);
  EXPECT_EQ(array.size_bytes(), 0u);
}

TEST(AlignedVector, StartsOnACacheLineAndPadsToPackets) {
  for (const std::size_t size : {1u, 15u, 16u, 17u, 4096u}) {
    AlignedVector<float> values(padded(size));
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(values.data()) % kCacheLine, 0u);
    EXPECT_EQ(values.size() % kLanes, 0u);
    EXPECT_GE(values.size(), size);
    EXPECT_LT(values.size(), size + kLanes);
  }
}

}  // namespace
}  // namespace sightline
