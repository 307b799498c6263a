#include "film/exact_sum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace sightline {
namespace {

TEST(ExactSum, DoesNotDependOnTheOrder) {
  std::mt19937 random(1);
  std::vector<float> values;
  for (int i = 0; i < 10000; ++i) {
    const int exponent = static_cast<int>(random() % 60) - 30;
    values.push_back(std::ldexp(static_cast<float>(random()) * 0x1p-32f - 0.3f, exponent));
  }
  ExactSum forward, shuffled, parts[7];
  for (const float v : values) forward.add(v);
  std::shuffle(values.begin(), values.end(), random);
  for (std::size_t i = 0; i < values.size(); ++i) shuffled.add(values[i]), parts[i % 7].add(values[i]);
  EXPECT_EQ(forward, shuffled);
  ExactSum merged;
  for (const ExactSum& part : parts) merged.value += part.value;
  EXPECT_EQ(forward, merged);
}

TEST(ExactSum, IsExactWhereFloatsFitTheUnit) {
  ExactSum sum;
  for (const float v : {1.f, 0x1p-40f, -0.25f, 1e9f, -1e9f, 3.1415927f}) EXPECT_TRUE(sum.add(v));
  EXPECT_EQ(sum.to_double(), 0.75 + 0x1p-40 + static_cast<double>(3.1415927f));
}

TEST(ExactSum, CutsBelowTheUnitAndSaturatesAbove) {
  ExactSum sum;
  EXPECT_TRUE(sum.add(0x1p-70f));
  EXPECT_TRUE(sum.add(1e-44f));
  EXPECT_TRUE(sum.add(0.f));
  EXPECT_TRUE(sum.add(-0.f));
  EXPECT_EQ(sum, ExactSum{});
  EXPECT_TRUE(sum.add(0x1p-64f));
  EXPECT_EQ(sum.to_double(), 0x1p-64);
  ExactSum large;
  EXPECT_FALSE(large.add(0x1p60f));
  EXPECT_EQ(large.to_double(), 0x1p40);
  EXPECT_FALSE(large.add(-3e38f));
  EXPECT_EQ(large.to_double(), 0);
  EXPECT_TRUE(large.add(0x1.fffffep39f));
  EXPECT_EQ(large.to_double(), 0x1.fffffep39);
}

}  // namespace
}  // namespace sightline
