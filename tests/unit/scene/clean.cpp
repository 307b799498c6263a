#include <gtest/gtest.h>

#include <limits>

#include "scene/load/load.h"

namespace sightline {
namespace {

TEST(DropBadTriangles, KeepsTheGoodOnesInOrderWithTheirMaterials) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  std::vector<Vec3> positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {kNan, 0, 0}, {1, 1, 0}, {2, 0, 0}, {0, 0, 0}};
  std::vector<UVec3> triangles = {{0, 1, 2}, {0, 1, 3}, {1, 1, 2}, {1, 4, 2}, {0, 1, 7}, {0, 1, 5}, {0, 6, 1}, {0, 1, 4}};
  std::vector<std::uint16_t> materials = {10, 11, 12, 13, 14, 15, 16, 17};
  std::uint64_t dropped = 100;
  drop_bad_triangles(positions, triangles, &materials, dropped);
  EXPECT_EQ(triangles, (std::vector<UVec3>{{0, 1, 2}, {1, 4, 2}, {0, 1, 4}}));
  EXPECT_EQ(materials, (std::vector<std::uint16_t>{10, 13, 17}));
  EXPECT_EQ(dropped, 105u) << "not finite, repeated, out of range, collinear, coincident";
  for (const Vec3& p : positions) EXPECT_TRUE(is_finite(p));
}

TEST(DropBadTriangles, KeepsTinyTrianglesThatFloatsCanTellApart) {
  // The area underflows in single precision but not in double.
  std::vector<Vec3> positions = {{0, 0, 0}, {1e-30f, 0, 0}, {0, 1e-30f, 0}};
  std::vector<UVec3> triangles = {{0, 1, 2}};
  std::uint64_t dropped = 0;
  drop_bad_triangles(positions, triangles, nullptr, dropped);
  EXPECT_EQ(triangles.size(), 1u);
}

TEST(DropBadTriangles, SurvivesNothing) {
  std::vector<Vec3> positions;
  std::vector<UVec3> triangles = {{0, 1, 2}};
  std::uint64_t dropped = 0;
  drop_bad_triangles(positions, triangles, nullptr, dropped);
  EXPECT_TRUE(triangles.empty());
  EXPECT_EQ(dropped, 1u);
}

}  // namespace
}  // namespace sightline
