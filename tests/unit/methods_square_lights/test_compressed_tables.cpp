#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <vector>

#include "base/core/error.h"
#include "methods/square_lights/binary16.h"
#include "methods/square_lights/components.h"
#include "methods/square_lights/compressed_tables.h"
#include "methods/square_lights/table_lanes.h"
#include "support/every_target.h"

namespace sightline::square_lights {
namespace {

std::span<std::int8_t, kTableCells> cells(std::vector<std::int8_t>& tables, std::size_t i) {
  return std::span<std::int8_t, kTableCells>(tables.data() + i * kTableCells, kTableCells);
}

/// Tables of edges and disks at random places.
std::vector<std::int8_t> random_tables(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  const DiskGrid grid(32);
  std::vector<std::int8_t> tables(count * kTableCells);
  std::vector<std::uint8_t> map(grid.count());
  for (std::size_t i = 0; i < count; ++i) {
    const float turn = 6.28f * unit(random), offset = unit(random) - 0.5f, radius = 0.1f + 0.5f * unit(random);
    const Vec2 normal(std::cos(turn), std::sin(turn));
    for (std::size_t k = 0; k < map.size(); ++k) {
      const Vec2 p = grid.point(k);
      map[k] = i % 2 ? glm::dot(p, normal) > offset : glm::length(p - offset * normal) > radius;
    }
    make_distance_table(map, 32, cells(tables, i));
  }
  return tables;
}

double error_of(const std::vector<std::int8_t>& tables, const CompressionOptions& options) {
  const Context context;
  return CompressedTables::cluster(tables, tables.size() / kTableCells, options, context).squared_error(tables, context);
}

TEST(CompressedTables, WithAClusterATableReproduceThemExactly) {
  const auto tables = random_tables(60, 1);
  for (const int vectors : {0, 3}) EXPECT_EQ(error_of(tables, {.clusters = 60, .vectors = vectors, .iterations = 2}), 0) << vectors;
  EXPECT_EQ(error_of(tables, {.clusters = 5000}), 0) << "no more clusters than tables";
}

TEST(CompressedTables, ErrorFallsWithVectorsAndClusters) {
  const auto tables = random_tables(400, 2);
  double last = std::numeric_limits<double>::infinity();
  for (const int vectors : {0, 1, 2, 4, 8, 16}) {
    const double error = error_of(tables, {.clusters = 8, .vectors = vectors, .iterations = 2});
    EXPECT_LT(error, 0.95 * last) << vectors;
    last = error;
  }
  EXPECT_LT(error_of(tables, {.clusters = 32, .vectors = 4}), 0.8 * error_of(tables, {.clusters = 8, .vectors = 4}));
}

TEST(CompressedTables, ErrorNeverGrowsWithIterations) {
  const auto tables = random_tables(500, 3);
  double last = std::numeric_limits<double>::infinity(), first = 0;
  for (int iterations = 0; iterations < 6; ++iterations) {
    // More clusters than are tried for each table after the first round.
    const double error = error_of(tables, {.clusters = 40, .vectors = 3, .iterations = iterations});
    EXPECT_LE(error, last * 1.002) << iterations << ": but for the rounding of codes";
    if (iterations == 0) first = error;
    last = error;
  }
  EXPECT_LT(last, 0.97 * first);
}

TEST(CompressedTables, HoldsFewDirectionsExactly) {
  // Tables that are sums of three patterns are what three vectors are for.
  std::mt19937 random(4);
  std::vector<std::int8_t> tables(200 * kTableCells);
  for (std::size_t i = 0; i < 200; ++i) {
    const int a = static_cast<int>(random() % 31) - 15, b = static_cast<int>(random() % 31) - 15, c = static_cast<int>(random() % 31) - 15;
    for (std::size_t k = 0; k < kTableCells; ++k)
      tables[i * kTableCells + k] =
          static_cast<std::int8_t>(a * (k % 2 ? 1 : -1) + b * (k % 64 < 32 ? 1 : 2) + c * static_cast<int>(k / 512));
  }
  EXPECT_EQ(error_of(tables, {.clusters = 1, .vectors = 3}), 0);
  EXPECT_GT(error_of(tables, {.clusters = 1, .vectors = 2}), 0);
}

TEST(CompressedTables, AreTheSameForAnyNumberOfThreads) {
  const auto tables = random_tables(300, 5);
  std::vector<std::vector<std::uint16_t>> stored;
  for (const int threads : {1, 3}) {
    Context context;
    context.threads = threads;
    const auto compressed = CompressedTables::cluster(tables, 300, {.clusters = 20, .vectors = 4, .iterations = 3}, context);
    stored.emplace_back(compressed.cluster_of().begin(), compressed.cluster_of().end());
    stored.back().insert(stored.back().end(), compressed.weights().begin(), compressed.weights().end());
    stored.back().insert(stored.back().end(), compressed.components().begin(), compressed.components().end());
  }
  EXPECT_EQ(stored[0], stored[1]);
}

TEST(CompressedTables, LeavesNoClusterEmpty) {
  // A hundred times the same table, and three others.
  auto tables = random_tables(4, 6);
  for (int i = 0; i < 100; ++i) tables.insert(tables.end(), tables.begin(), tables.begin() + kTableCells);
  const Context context;
  const auto compressed = CompressedTables::cluster(tables, 104, {.clusters = 6, .vectors = 2}, context);
  const std::set<std::uint16_t> used(compressed.cluster_of().begin(), compressed.cluster_of().end());
  EXPECT_EQ(used.size(), 6u);
  EXPECT_EQ(compressed.squared_error(tables, context), 0);
}

TEST(CompressedTables, GroupsKeepTheirTables) {
  const auto tables = random_tables(90, 7);
  std::vector<std::uint16_t> group(90);
  for (std::size_t i = 0; i < 90; ++i) group[i] = static_cast<std::uint16_t>(i % 3);
  const Context context;
  const auto compressed = CompressedTables::groups(tables, group, 4, 5, context);
  EXPECT_TRUE(std::equal(group.begin(), group.end(), compressed.cluster_of().begin()));
  // Each group's error is that of its tables alone.
  double alone = 0;
  for (std::size_t g = 0; g < 3; ++g) {
    std::vector<std::int8_t> own;
    for (std::size_t i = g; i < 90; i += 3)
      own.insert(own.end(), tables.begin() + static_cast<std::ptrdiff_t>(i * kTableCells),
                 tables.begin() + static_cast<std::ptrdiff_t>((i + 1) * kTableCells));
    alone += error_of(own, {.clusters = 1, .vectors = 5, .iterations = 0});
  }
  EXPECT_NEAR(compressed.squared_error(tables, context), alone, 0.01 * alone);
  EXPECT_EQ(compressed.bytes(), 2 * (90 + 90 * 5 + 4 * 6 * kTableCells));
}

TEST(CompressedTables, ComeBackFromTheirArraysAndRefuseOthers) {
  const auto tables = random_tables(50, 8);
  const Context context;
  const auto made = CompressedTables::cluster(tables, 50, {.clusters = 5, .vectors = 3}, context);
  const auto again = CompressedTables::from_arrays(made.cluster_of(), made.weights(), made.components(), 3);
  EXPECT_EQ(again.squared_error(tables, context), made.squared_error(tables, context));
  const auto refused = [](std::span<const std::uint16_t> c, std::span<const std::uint16_t> w, std::span<const std::uint16_t> e, int n) {
    EXPECT_THROW(CompressedTables::from_arrays(c, w, e, n), Error);
  };
  refused(made.cluster_of(), made.weights(), made.components(), 4);
  refused(made.cluster_of(), made.weights().first(149), made.components(), 3);
  refused(made.cluster_of(), made.weights(), made.components().first(4 * 4 * kTableCells), 3);
  refused(made.cluster_of(), made.weights(), made.components().first(5), 3);
  refused(made.cluster_of(), made.weights(), made.components(), -1);
  refused(made.cluster_of(), made.weights(), made.components(), 100000);
}

TEST(CompressedTables, ReportProgressAndStop) {
  const auto tables = random_tables(200, 9);
  Context context;
  std::atomic<double> done{0}, total{0};
  context.progress = [&](const Progress& progress) { done = std::max(done.load(), progress.done), total = progress.total; };
  CompressedTables::cluster(tables, 200, {.clusters = 10, .vectors = 2}, context);
  EXPECT_GT(total, 0);
  EXPECT_EQ(done, total);
  context.progress = [&](const Progress&) { context.cancelled = true; };
  EXPECT_THROW(CompressedTables::cluster(tables, 200, {.clusters = 10, .vectors = 2}, context), Error);
}

TEST(CompressedTables, OfNothingAreEmpty) { EXPECT_EQ(CompressedTables::cluster({}, 0, {}, Context()).count(), 0u); }

TEST(FitComponents, AreOrthonormalAndBestAmongAllDirections) {
  const auto tables = random_tables(80, 10);
  std::vector<std::uint32_t> members(80);
  for (std::uint32_t i = 0; i < 80; ++i) members[i] = i;
  Components components;
  fit_components(tables, members, 6, 12, components);
  const auto left = [&](const AlignedVector<float>& vectors, std::size_t count) {
    double sum = 0;
    std::vector<float> dots(count);
    for (std::size_t i = 0; i < 80; ++i) {
      sum += project_table(tables.data() + i * kTableCells, components.mean.data(), vectors.data(), count, dots.data());
      for (const float d : dots) sum -= static_cast<double>(d) * d;
    }
    return sum;
  };
  for (std::size_t a = 0; a < 6; ++a) {
    for (std::size_t b = 0; b <= a; ++b) {
      double dot = 0;
      for (std::size_t k = 0; k < kTableCells; ++k)
        dot += static_cast<double>(components.vectors[a * kTableCells + k]) * components.vectors[b * kTableCells + k];
      EXPECT_NEAR(dot, a == b, 1e-4) << a << " " << b;
    }
  }
  // Falling importance, and many more sweeps find nothing better.
  double last = left(components.vectors, 0), gain = std::numeric_limits<double>::infinity();
  for (std::size_t n = 1; n <= 6; ++n) {
    const double now = left(components.vectors, n);
    EXPECT_LE(last - now, gain * 1.001);
    gain = last - now, last = now;
  }
  Components patient;
  fit_components(tables, members, 6, 100, patient);
  EXPECT_LT(left(components.vectors, 6), 1.002 * left(patient.vectors, 6));
}

TEST(ExpandTable, IsTheRoundedSumOnEveryTarget) {
  std::mt19937 random(11);
  AlignedVector<std::uint16_t> components(5 * kTableCells);
  for (std::uint16_t& half : components) half = half_from_float((static_cast<float>(random() % 2000) - 1000) * 0.2f);
  const float weights[4] = {0.3f, -0.5f, 0.01f, 1};
  std::vector<float> expected(kTableCells);
  for (std::size_t i = 0; i < kTableCells; ++i) {
    expected[i] = float_from_half(components[i]);
    for (std::size_t j = 0; j < 4; ++j) expected[i] += weights[j] * float_from_half(components[(j + 1) * kTableCells + i]);
    expected[i] = std::clamp(expected[i], -127.f, 127.f);
  }
  for (const std::int64_t target : test::simd_targets()) {
    const test::PinnedTarget pinned(target);
    std::vector<std::int8_t> table(kTableCells);
    expand_table(components.data(), weights, 4, table.data());
    for (std::size_t i = 0; i < kTableCells; ++i) EXPECT_NEAR(table[i], expected[i], 0.501f) << hwy::TargetName(target);
  }
}

TEST(Binary16, RoundsToTheNearestBothWays) {
  // Every half is itself; halfway between two it is the even one.
  for (std::uint32_t bits = 0; bits < 0x7c00; ++bits) {
    const auto half = static_cast<std::uint16_t>(bits);
    const float value = float_from_half(half);
    EXPECT_EQ(half_from_float(value), half);
    EXPECT_EQ(half_from_float(-value), half | 0x8000);
    if (bits + 1 == 0x7c00) break;
    const float middle = 0.5f * (value + float_from_half(static_cast<std::uint16_t>(bits + 1)));
    EXPECT_EQ(half_from_float(middle), bits % 2 ? bits + 1 : bits) << bits;
    EXPECT_EQ(half_from_float(std::nextafter(middle, 0.f)), half);
    EXPECT_EQ(half_from_float(std::nextafter(middle, 1e9f)), bits + 1);
  }
  EXPECT_EQ(float_from_half(0x3c00), 1);
  EXPECT_EQ(float_from_half(0x0001), 0x1p-24f);
  EXPECT_EQ(half_from_float(65504), 0x7bff);
  EXPECT_EQ(half_from_float(1e6f), 0x7c00);
  EXPECT_EQ(half_from_float(-std::numeric_limits<float>::infinity()), 0xfc00);
  EXPECT_TRUE(std::isnan(float_from_half(half_from_float(std::nanf("")))));
  EXPECT_TRUE(std::isinf(float_from_half(0x7c00)));
}

}  // namespace
}  // namespace sightline::square_lights
