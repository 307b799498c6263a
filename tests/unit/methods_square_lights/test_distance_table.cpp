#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "methods/square_lights/distance_table.h"
#include "methods/square_lights/hemisphere_disk.h"

namespace sightline::square_lights {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Distances by trying every pair of points.
std::vector<float> brute_distances(const std::vector<std::uint8_t>& visible, int n) {
  std::vector<float> distances(visible.size());
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const bool here = visible[y * n + x];
      float least = kInfinity;
      for (int v = 0; v < n; ++v) {
        for (int u = 0; u < n; ++u) {
          const auto square = static_cast<float>((u - x) * (u - x) + (v - y) * (v - y));
          if (static_cast<bool>(visible[v * n + u]) != here) least = std::min(least, square);
        }
      }
      const float d = std::sqrt(least) - 0.5f;
      distances[y * n + x] = here ? d : -d;
    }
  }
  return distances;
}

std::vector<float> distances_of(const std::vector<std::uint8_t>& visible, int n) {
  std::vector<float> distances(visible.size());
  signed_distances(visible, n, distances);
  return distances;
}

/// Random maps of all kinds: noise of any density, blobs, half planes.
std::vector<std::uint8_t> random_map(std::mt19937& random, int n) {
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<std::uint8_t> map(static_cast<std::size_t>(n) * n);
  const int kind = static_cast<int>(random() % 3);
  const float density = std::pow(unit(random), 3.f), a = unit(random) * 6.28f, offset = unit(random) - 0.5f;
  Vec2 centers[3];
  float radii[3];
  for (int k = 0; k < 3; ++k) centers[k] = Vec2(unit(random), unit(random)) * static_cast<float>(n), radii[k] = unit(random) * 0.3f * n;
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      bool set = false;
      if (kind == 0) set = unit(random) < density;
      if (kind == 1) set = std::cos(a) * (x - n / 2) + std::sin(a) * (y - n / 2) < offset * n;
      for (int k = 0; kind == 2 && k < 3; ++k) set |= glm::length(Vec2(x, y) - centers[k]) < radii[k];
      map[y * n + x] = set;
    }
  }
  return map;
}

TEST(SignedDistances, EqualBruteForceOnRandomMaps) {
  std::mt19937 random(7);
  for (int i = 0; i < 1000; ++i) {
    const int n = i % 10 == 0 ? 48 : 1 + static_cast<int>(random() % 24);
    const auto map = random_map(random, n);
    ASSERT_EQ(distances_of(map, n), brute_distances(map, n)) << "map " << i << " of " << n;
  }
}

TEST(SignedDistances, OfSinglePointsEmptyAndFullMaps) {
  for (const int n : {1, 2, 15, 16, 17, 33, 64}) {
    const std::size_t count = static_cast<std::size_t>(n) * n;
    for (const std::size_t at : {std::size_t{0}, count / 2, count - 1}) {
      std::vector<std::uint8_t> map(count, 1);
      map[at] = 0;
      EXPECT_EQ(distances_of(map, n), brute_distances(map, n)) << n;
      map.assign(count, 0);
      map[at] = 1;
      EXPECT_EQ(distances_of(map, n), brute_distances(map, n)) << n;
    }
    EXPECT_EQ(distances_of(std::vector<std::uint8_t>(count, 1), n), std::vector<float>(count, kInfinity));
    EXPECT_EQ(distances_of(std::vector<std::uint8_t>(count, 0), n), std::vector<float>(count, -kInfinity));
  }
}

TEST(SignedDistances, ReachAcrossLargeMaps) {
  const int n = 256;
  std::vector<std::uint8_t> map(static_cast<std::size_t>(n) * n, 1);
  map[0] = 0;
  const auto distances = distances_of(map, n);
  EXPECT_FLOAT_EQ(distances.back(), std::sqrt(2.f * 255 * 255) - 0.5f);
}

std::vector<std::int8_t> table_of(const std::vector<std::uint8_t>& map, int n) {
  std::vector<std::int8_t> table(kTableCells);
  make_distance_table(map, n, std::span<std::int8_t, kTableCells>(table.data(), kTableCells));
  return table;
}
TableView view(const std::vector<std::int8_t>& table) { return TableView(table.data(), kTableCells); }

/// Visible where dot(p, normal) > offset.
std::vector<std::uint8_t> half_plane(int n, const Vec2& normal, float offset) {
  const DiskGrid grid(n);
  std::vector<std::uint8_t> map(grid.count());
  for (std::size_t i = 0; i < map.size(); ++i) map[i] = glm::dot(grid.point(i), normal) > offset;
  return map;
}

TEST(DistanceTable, HoldsTheDistanceToStraightEdges) {
  for (const int n : {32, 64, 128}) {
    for (int k = 0; k < 16; ++k) {
      const float turn = static_cast<float>(k) * 0.4f;
      const Vec2 normal(std::cos(turn), std::sin(turn));
      const auto table = table_of(half_plane(n, normal, 0.2f), n);
      float worst = 0;
      for (int i = 0; i < 400; ++i) {
        // Far from the square's border, where the edge ends.
        const Vec2 p = Vec2(static_cast<float>(i % 20), static_cast<float>(i / 20)) / 19.f - 0.5f;
        worst = std::max(worst, std::fabs(distance_at(view(table), p) - (glm::dot(p, normal) - 0.2f)));
      }
      // Half a step of the code, and what is lost of slanted edges between points: less than half a cell of the map.
      EXPECT_LT(worst, 0.5f * kDistanceStep + 1.f / static_cast<float>(n)) << n << " points, turn " << turn;
    }
  }
}

TEST(DistanceTable, IsExactForEdgesBetweenPoints) {
  const auto table = table_of(half_plane(64, {1, 0}, 0.25f), 64);
  for (float x = -0.9f; x < 0.9f; x += 0.013f) EXPECT_NEAR(distance_at(view(table), {x, 0.3f}), x - 0.25f, 0.51f * kDistanceStep) << x;
}

TEST(DistanceTable, WithoutABoundaryHoldsTheGreatestDistance) {
  EXPECT_EQ(table_of(std::vector<std::uint8_t>(4096, 1), 64), std::vector<std::int8_t>(kTableCells, 127));
  EXPECT_EQ(table_of(std::vector<std::uint8_t>(4096, 0), 64), std::vector<std::int8_t>(kTableCells, -127));
}

TEST(DistanceTable, LookUpIsBilinearAndClamped) {
  std::vector<std::int8_t> table(kTableCells);
  for (int y = 0; y < kTableSize; ++y) {
    for (int x = 0; x < kTableSize; ++x) table[y * kTableSize + x] = static_cast<std::int8_t>(2 * x - 3 * y);
  }
  // A plane is interpolated exactly, with its slope.
  for (const Vec2 p : {Vec2(0.1f, -0.2f), Vec2(-0.93f, 0.93f), Vec2(0.f, 0.f), Vec2(0.9f, 0.5f)}) {
    const Vec2 cell = p * 16.f + 15.5f;
    Vec2 gradient;
    EXPECT_NEAR(distance_at(view(table), p, gradient), (2 * cell.x - 3 * cell.y) * kDistanceStep, 1e-5f);
    EXPECT_NEAR(gradient.x, 32 * kDistanceStep, 1e-4f);
    EXPECT_NEAR(gradient.y, -48 * kDistanceStep, 1e-4f);
  }
  EXPECT_EQ(distance_at(view(table), {5, -7}), decode_distance(62));
  EXPECT_EQ(distance_at(view(table), {-5, 7}), decode_distance(-93));
}

TEST(DistanceTable, CodesRoundToTheNearestStep) {
  for (float d = -1.49f; d < 1.49f; d += 0.0137f) EXPECT_NEAR(decode_distance(encode_distance(d)), d, 0.5001f * kDistanceStep);
  EXPECT_EQ(encode_distance(kInfinity), 127);
  EXPECT_EQ(encode_distance(-2.f), -127);
}

TEST(FillOutside, GivesThePointsBeyondTheDiskTheNearestInside) {
  const int n = 32;
  const DiskGrid grid(n);
  std::size_t inside = 0;
  for (std::size_t i = 0; i < grid.count(); ++i) {
    inside += grid.inside(i);
    EXPECT_EQ(grid.inside(i), glm::length(grid.point(i)) <= 1);
    float least = kInfinity;
    for (std::size_t j = 0; j < grid.count(); ++j) {
      if (glm::length(grid.point(j)) <= 1) least = std::min(least, glm::length(grid.point(j) - grid.point(i)));
    }
    EXPECT_NEAR(glm::length(grid.point(grid.nearest_inside()[i]) - grid.point(i)), least, 1e-6f);
  }
  EXPECT_NEAR(static_cast<float>(inside) / static_cast<float>(grid.count()), kPi / 4, 0.01f);

  // An open hemisphere has no boundary, unless the horizon counts as one.
  std::vector<std::uint8_t> map(grid.count(), 0);
  for (std::size_t i = 0; i < map.size(); ++i) map[i] = grid.inside(i);
  std::vector<std::uint8_t> counted = map;
  fill_outside(grid, false, map);
  EXPECT_EQ(table_of(map, n), std::vector<std::int8_t>(kTableCells, 127));
  fill_outside(grid, true, counted);
  const auto table = table_of(counted, n);
  EXPECT_NEAR(distance_at(view(table), {0.6f, -0.6f}), 1 - 0.6f * std::sqrt(2.f), 0.03f);
  EXPECT_LT(distance_at(view(table), {0.95f, 0.95f}), 0);
}

/// Area of the square of half diagonal r_p around 0, axis-parallel, where dot(p, normal) > -d, over its own, by counting points.
float counted_coverage(float d, float r_p, float turn) {
  const float half = r_p * 0.70710678f;
  constexpr int points = 600;
  int covered = 0;
  for (int j = 0; j < points; ++j) {
    for (int i = 0; i < points; ++i) {
      const Vec2 p = ((Vec2(static_cast<float>(i), static_cast<float>(j)) + 0.5f) * (2.f / points) - 1.f) * half;
      covered += std::cos(turn) * p.x + std::sin(turn) * p.y > -d;
    }
  }
  return static_cast<float>(covered) / (points * points);
}

TEST(Coverage, ParallelIsExactForParallelEdges) {
  for (const float r_p : {0.01f, 0.2f, 0.9f}) {
    for (float t = -1.2f; t <= 1.2f; t += 0.05f) {
      const float half = r_p * 0.70710678f, d = t * r_p;
      EXPECT_NEAR(covered_parallel(d, r_p), std::clamp((half + d) / (2 * half), 0.f, 1.f), 1e-5f);
      EXPECT_NEAR(covered_gradient(d, {0, -3}, r_p), covered_parallel(d, r_p), 1e-5f);
    }
  }
}

TEST(Coverage, OfTurnedEdgesIsWithinWhatEachPromises) {
  float worst_parallel = 0, worst_average = 0;
  for (int k = 0; k <= 16; ++k) {
    const float turn = static_cast<float>(k) / 16 * kPi / 4;
    for (float t = -1.1f; t <= 1.1f; t += 0.1f) {
      const float truth = counted_coverage(t * 0.3f, 0.3f, turn);
      worst_parallel = std::max(worst_parallel, std::fabs(covered_parallel(t * 0.3f, 0.3f) - truth));
      worst_average = std::max(worst_average, std::fabs(covered_average(t * 0.3f, 0.3f) - truth));
      EXPECT_NEAR(covered_gradient(t * 0.3f, {std::cos(turn), std::sin(turn)}, 0.3f), truth, 0.004f) << turn << " " << t;
    }
  }
  EXPECT_LT(worst_parallel, 0.0436f + 0.004f);
  EXPECT_GT(worst_parallel, 0.035f) << "the truth is not that of a parallel edge";
  EXPECT_LT(worst_average, 0.0286f + 0.004f);
}

TEST(Coverage, AverageIsTheMeanOverTurns) {
  for (const float t : {-0.9f, -0.3f, 0.f, 0.17f, 0.5f, 0.8f, 1.f, 1.5f}) {
    double sum = 0;
    for (int k = 0; k < 32; ++k) {
      const float turn = (static_cast<float>(k) + 0.5f) / 32 * kPi / 4;
      sum += covered_gradient(t * 0.4f, {std::cos(turn), std::sin(turn)}, 0.4f);
    }
    EXPECT_NEAR(covered_average(t * 0.4f, 0.4f), sum / 32, 0.001) << t;
  }
  EXPECT_EQ(covered_gradient(0.1f, {0, 0}, 0.4f), covered_average(0.1f, 0.4f));
}

TEST(Coverage, OfSquaresWithoutSizeIsAllOrNothing) {
  for (const auto covered : {covered_parallel, covered_average}) {
    EXPECT_EQ(covered(0.1f, 0), 1);
    EXPECT_EQ(covered(-0.1f, 0), 0);
  }
  EXPECT_EQ(covered_gradient(0.1f, {1, 1}, 0), 1);
  EXPECT_EQ(covered_gradient(-0.1f, {1, 1}, 0), 0);
}

}  // namespace
}  // namespace sightline::square_lights
