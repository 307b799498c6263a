// Radial basis functions at single texels.
#include <gtest/gtest.h>

#include <cmath>

#include "base/sample/sobol.h"
#include "methods/fragments/upsample_rbf.h"
#include "support/chi_square.h"
#include "test_upsample_support.h"

namespace sightline::test {
namespace {

using Evaluate = void (*)(const RbfRegion&, int, int, const std::array<float*, 3>&, std::size_t);

SignalSample sample(float x, float y, int level, float value) { return {x, y, 1 << level, level, {value, 2 * value, 3 * value}}; }

/// The value at one texel from its own sample and up to three others.
float value_at(Evaluate evaluate, float x, float y, const std::vector<SignalSample>& samples, float width, bool adaptive = true) {
  RbfRegion region{.x0 = static_cast<int>(std::floor(x)),
                   .y0 = static_cast<int>(std::floor(y)),
                   .cell_width = width,
                   .adaptive = adaptive,
                   .own = samples[0]};
  std::array<RbfCandidates, 3> lists;
  for (std::size_t i = 1; i < samples.size(); ++i) lists[i - 1].add(samples[i], 1), region.candidates[i - 1] = &lists[i - 1];
  float result = NAN;
  evaluate(region, 1, 1, {&result, nullptr, nullptr}, 1);
  return result;
}

TEST(UpsampleRbf, SamplesAreReproducedWhereTheyLie) {
  // Pixel centres as places, so that texels fall on them; three and four samples.
  for (const bool adaptive : {true, false})
    for (const int level : {3, 5, 7}) {
      const float w = static_cast<float>(1 << level), h = w / 2 + 0.5f;
      const std::vector<SignalSample> four = {sample(h, h, level, 0.4f), sample(0.5f, h, 0, 0.9f), sample(h, 0.5f, 0, 0.1f),
                                              sample(0.5f, 0.5f, 0, 0.6f)};
      for (const std::size_t n : {3u, 4u}) {
        const std::vector<SignalSample> samples(four.begin(), four.begin() + static_cast<std::ptrdiff_t>(n));
        for (const SignalSample& s : samples) EXPECT_NEAR(value_at(rbf_region, s.x, s.y, samples, w, adaptive), s.value[0], 1e-4f);
      }
    }
}

TEST(UpsampleRbf, ConstantFieldsAreExactForAnySetOfSamples) {
  Uniform random(13);
  for (int trial = 0; trial < 500; ++trial) {
    std::vector<SignalSample> samples = {sample(16, 16, 5, 0.3f)};
    for (int i = trial % 4; i > 0; --i) samples.push_back(sample(32 * random.next(), 32 * random.next(), i, 0.3f));
    for (const auto evaluate : {rbf_region, rbf_region_lanes})
      EXPECT_NEAR(value_at(evaluate, 32 * random.next(), 32 * random.next(), samples, 32, trial % 2 == 0), 0.3f, 1e-6f);
  }
}

TEST(UpsampleRbf, TwoSamplesAreWeightedAsInEquation9) {
  // Levels 3 and 0, two widths of 8 apart: alpha = exp(-d^2 / 2) and C = 2 (level + 1), by hand.
  const std::vector<SignalSample> samples = {sample(4, 4, 3, 0.2f), sample(12.5f, 4.5f, 0, 0.7f)};
  const float x = 6.5f, y = 4.5f;
  const auto d2 = [&](const SignalSample& s) { return ((s.x - x) * (s.x - x) + (s.y - y) * (s.y - y)) / 64; };
  const float a0 = std::exp(-d2(samples[0]) / 2), a1 = std::exp(-d2(samples[1]) / 2), c = 2 * (3 * a0 / (a0 + a1) + 1);
  const float p0 = std::exp(-d2(samples[0]) / c), p1 = std::exp(-d2(samples[1]) / c);
  EXPECT_NEAR(value_at(rbf_region, x, y, samples, 8), (0.2f * p0 + 0.7f * p1) / (p0 + p1), 1e-6f);
}

TEST(UpsampleRbf, CoincidentAndCollinearSamplesGiveValuesInRange) {
  Uniform random(11);
  for (int trial = 0; trial < 2000; ++trial) {
    const int level = 3 + trial % 5;
    const float w = static_cast<float>(1 << level);
    std::vector<SignalSample> samples = {sample(w / 2, w / 2, level, random.next())};
    const float direction = 6.2831853f * random.next();
    for (int i = 0; i < 3; ++i) {
      const float along = trial % 2 ? 0.f : w * random.next(), off = trial % 3 ? 0.f : 1e-3f * random.next();
      samples.push_back(sample(w / 2 + along * std::cos(direction) + off, w / 2 + along * std::sin(direction), i, random.next()));
    }
    for (const bool adaptive : {true, false})
      for (const auto evaluate : {rbf_region, rbf_region_lanes}) {
        const float v = value_at(evaluate, w * random.next(), w * random.next(), samples, w, adaptive);
        EXPECT_TRUE(v >= 0 && v <= 1) << v;
      }
  }
}

TEST(UpsampleRbf, SamplesBeyondTwoWidthsAreNotUsed) {
  EXPECT_EQ(value_at(rbf_region, 2.5f, 2.5f, {sample(4, 4, 3, 0.25f), sample(18.6f, 2.5f, 4, 1)}, 8), 0.25f);
  EXPECT_GT(value_at(rbf_region, 2.5f, 2.5f, {sample(4, 4, 3, 0.25f), sample(18.4f, 2.5f, 4, 1)}, 8), 0.26f);
}

TEST(UpsampleRbf, LanesAgreeWithTheDefinitionOnEveryTarget) {
  for (const std::int64_t target : simd_targets()) {
    const PinnedTarget pinned(target);
    Uniform random(12);
    for (int trial = 0; trial < 300; ++trial) {
      const int level = 1 + trial % 7, size = 1 << (level - 1), channels = trial % 2 ? 1 : 3;
      const float w = static_cast<float>(2 * size);
      RbfRegion region{.x0 = 1024,
                       .y0 = 512,
                       .size = size,
                       .cell_width = w,
                       .adaptive = trial % 3 != 0,
                       .channels = channels,
                       .own = sample(1024 + w / 2, 512 + w / 2, level, random.next() / 3)};
      std::array<RbfCandidates, 3> lists;
      for (std::size_t k = 0; k < 3; ++k) {
        for (int i = static_cast<int>(6 * random.next()); i > 0; --i) {
          // On a lattice of quarters of the width, as fragments are; some too far, some twice.
          const float x = 1024 + w / 4 * std::floor(10 * random.next() - 5), y = 512 + w / 4 * std::floor(10 * random.next() - 5);
          lists[k].add(sample(x, y, static_cast<int>(8 * random.next()), random.next() / 3), channels);
        }
        if (random.next() < 0.8f) region.candidates[k] = &lists[k];
      }
      const int columns = std::min(size, 1 + static_cast<int>(64 * random.next())),
                rows = std::min(size, 1 + static_cast<int>(64 * random.next()));
      std::array<std::vector<float>, 3> a, b;
      std::array<float*, 3> to_a{}, to_b{};
      for (std::size_t c = 0; c < 3; ++c) a[c].assign(70 * 70, -7), b[c].assign(70 * 70, -7), to_a[c] = a[c].data(), to_b[c] = b[c].data();
      rbf_region(region, columns, rows, to_a, 70), rbf_region_lanes(region, columns, rows, to_b, 70);
      for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < a[c].size(); ++i) ASSERT_NEAR(a[c][i], b[c][i], 1e-3f) << "trial " << trial << " at " << i;
    }
  }
}

}  // namespace
}  // namespace sightline::test
