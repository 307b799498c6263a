#include "base/sample/alias_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "support/chi_square.h"

namespace sightline {
namespace {

/// Probability of each index, measured by the bins themselves.
std::vector<double> probabilities_of_bins(const AliasTable& table) {
  std::vector<double> p(table.size());
  for (std::size_t i = 0; i < table.size(); ++i) {
    const AliasTable::Bin bin = table.bins()[i];
    p[i] += bin.threshold;
    p[bin.alias] += 1.0 - bin.threshold;
  }
  for (double& x : p) x /= static_cast<double>(table.size());
  return p;
}

TEST(AliasTable, BinsCarryExactlyTheWeights) {
  test::Uniform random(1);
  for (const std::size_t n : {1u, 2u, 3u, 17u, 1000u, 100000u}) {
    std::vector<float> weights(n);
    for (float& w : weights) w = std::pow(random.next(), 8.f);
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    const AliasTable table(weights);
    EXPECT_NEAR(table.sum(), sum, 1e-9 * sum);
    const std::vector<double> p = probabilities_of_bins(table);
    double total = 0;
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_NEAR(p[i], weights[i] / sum, 2e-7 / std::sqrt(static_cast<double>(n)) + 1e-6 * p[i]);
      EXPECT_NEAR(table.probability(static_cast<std::uint32_t>(i)), weights[i] / sum, 1e-7 * weights[i] / sum + 1e-12);
      total += table.probability(static_cast<std::uint32_t>(i));
    }
    EXPECT_NEAR(total, 1, 1e-6);
  }
}

TEST(AliasTable, ChoicesFollowTheWeights) {
  std::vector<float> weights{1, 0, 5, 0.25f, 3, 0, 2, 8, 0.01f, 4};
  const AliasTable table(weights);
  std::vector<double> observed(weights.size()), expected(weights.size());
  test::Uniform random(2);
  constexpr int count = 200000;
  for (int i = 0; i < count; ++i) ++observed[table.sample(random.next()).index];
  for (std::size_t i = 0; i < weights.size(); ++i)
    expected[i] = count * static_cast<double>(table.probability(static_cast<std::uint32_t>(i)));
  const auto result = test::chi_square(observed, expected);
  EXPECT_GT(result.p_value, 1e-4) << result.table;
  EXPECT_EQ(observed[1], 0);
}

TEST(AliasTable, StretchedNumberIsUniformWithinEachChoice) {
  const AliasTable table(std::vector<float>{1, 2, 3.5f, 0.1f});
  std::vector<std::vector<double>> histogram(4, std::vector<double>(10));
  constexpr int count = 1 << 20;
  for (int i = 0; i < count; ++i) {
    const AliasTable::Choice choice = table.sample(static_cast<float>(i) / count);
    ASSERT_GE(choice.u, 0);
    ASSERT_LT(choice.u, 1);
    ++histogram[choice.index][static_cast<std::size_t>(choice.u * 10)];
  }
  for (const auto& h : histogram) {
    const double mean = std::accumulate(h.begin(), h.end(), 0.0) / 10;
    for (const double cell : h) EXPECT_NEAR(cell, mean, 8);
  }
}

TEST(AliasTable, ImpossibleEntriesAreNeverChosen) {
  test::Uniform random(5);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<float> weights(1 + static_cast<std::size_t>(random.next() * 40));
    for (float& w : weights) w = random.next() < 0.5f ? 0.f : random.next() * std::exp(20 * random.next());
    weights[0] = 1;
    const AliasTable table(weights);
    for (int i = 0; i < 500; ++i) {
      // Also the ends of the interval.
      const float u = i == 0 ? 0.f : i == 1 ? 0x1.fffffep-1f : random.next();
      EXPECT_GT(weights[table.sample(u).index], 0);
    }
  }
}

TEST(AliasTable, BadWeightsCountAsNothing) {
  const AliasTable table(std::vector<float>{-1, std::numeric_limits<float>::quiet_NaN(), 2, std::numeric_limits<float>::infinity()});
  EXPECT_EQ(table.sample(0.1f).index, 2u);
  EXPECT_EQ(table.sample(0.9f).index, 2u);
  EXPECT_EQ(table.probability(2), 1);
  EXPECT_FALSE(AliasTable(std::vector<float>{0, 0}).can_sample());
  EXPECT_FALSE(AliasTable(std::vector<float>{}).can_sample());
}

}  // namespace
}  // namespace sightline
