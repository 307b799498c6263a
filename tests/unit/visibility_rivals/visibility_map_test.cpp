// The table of voxel pairs by itself.
#include "visibility/nee_plus_plus/visibility_map.h"

#include <gtest/gtest.h>

#include <set>

#include "unit/trace/trace_scenes.h"

namespace sightline::test {
namespace {

Bounds unit_box() {
  Bounds bounds;
  bounds.add(Vec3(-1)), bounds.add(Vec3(1));
  return bounds;
}

TEST(VisibilityMap, EachUnorderedPairHasAnEntryOfItsOwn) {
  constexpr std::uint32_t kVoxels = 27, kDirections = 4;
  VisibilityMap map(unit_box(), 3, kDirections);
  std::set<std::uint32_t> entries;
  for (std::uint32_t a = 0; a < kVoxels; ++a) {
    for (std::uint32_t b = 0; b <= a; ++b) {
      EXPECT_EQ(VisibilityMap::entry(a, b), VisibilityMap::entry(b, a));
      entries.insert(VisibilityMap::entry(a, b));
    }
    for (std::uint32_t cell = 0; cell < kDirections * kDirections; ++cell) entries.insert(map.entry_of_direction(a, cell));
  }
  const std::size_t count = kVoxels * (kVoxels + 1) / 2 + kVoxels * kDirections * kDirections;
  EXPECT_EQ(entries.size(), count);
  EXPECT_EQ(*entries.rbegin(), count - 1);
  EXPECT_EQ(VisibilityMap::bytes(3, kDirections), count * 9);
}

TEST(VisibilityMap, VoxelsAreEqualBoxesAndPointsOutsideGoToTheNearest) {
  const VisibilityMap map(unit_box(), 4, 0);
  std::mt19937 random(1);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 p = random_point(random, 1.5f), inside = glm::clamp(p, Vec3(-0.9999f), Vec3(0.9999f));
    const UVec3 cell((inside + 1.f) * 2.f);
    EXPECT_EQ(map.voxel_of(p), (cell.z * 4 + cell.y) * 4 + cell.x);
  }
  EXPECT_LT(map.voxel_of(Vec3(std::numeric_limits<float>::quiet_NaN())), 64u);
}

TEST(VisibilityMap, CellsOfDirectionsAreConnectedAndAllUsed) {
  const VisibilityMap map(unit_box(), 2, 8);
  std::mt19937 random(2);
  std::set<std::uint32_t> cells;
  std::vector<Vec3> first(64, Vec3(0));
  for (int i = 0; i < 20000; ++i) {
    const Vec3 d = random_direction(random);
    const std::uint32_t cell = map.direction_cell(d);
    ASSERT_LT(cell, 64u);
    if (cells.insert(cell).second) first[cell] = d;
    EXPECT_GT(glm::dot(first[cell], d), 0.6f) << cell;
  }
  EXPECT_EQ(cells.size(), 64u);
}

TEST(VisibilityMap, ProbabilitiesAreThoseOfTheCountsWithinTheirLimits) {
  VisibilityMap map(unit_box(), 2, 0);
  const std::uint32_t entry = VisibilityMap::entry(3, 5);
  const VisibilityMap::Limits limits{.min_tests = 100, .min_probability = 0.125f, .sure_from = 0.9f};
  map.learn(entry, 99, 50);
  EXPECT_EQ(map.odds(entry), 0);
  map.freeze(limits, Context());
  EXPECT_EQ(map.odds(entry), 0) << "too few tests";
  map.learn(entry, 101, 50);
  EXPECT_EQ(map.odds(entry), 0) << "not frozen";
  map.freeze(limits, Context());
  EXPECT_EQ(map.odds(entry), 128);
  map.learn(entry, 1800, 0);
  map.freeze(limits, Context());
  EXPECT_EQ(map.odds(entry), 32) << "never below the least";
  map.learn(entry, 100000, 99000);
  map.freeze(limits, Context());
  EXPECT_EQ(map.odds(entry), 0) << "sure";
  EXPECT_EQ(map.odds(VisibilityMap::entry(3, 4)), 0);
}

}  // namespace
}  // namespace sightline::test
