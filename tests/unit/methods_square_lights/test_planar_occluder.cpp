#include <gtest/gtest.h>

#include <random>

#include "methods/square_lights/planar_occluder.h"
#include "methods/square_lights/shade_lanes.h"
#include "support/every_target.h"

namespace sightline::square_lights {
namespace {

/// Corners and inner points of a rectangle in the plane y = 0.
std::vector<Vec3> rectangle(float half_x, float half_z) {
  std::vector<Vec3> points;
  for (int i = -2; i <= 2; ++i)
    for (int k = -2; k <= 2; ++k) points.emplace_back(0.5f * half_x * static_cast<float>(i), 0.f, 0.5f * half_z * static_cast<float>(k));
  return points;
}

Vec3 random_direction(std::mt19937& random) {
  std::normal_distribution<float> normal;
  return glm::normalize(Vec3(normal(random), normal(random), normal(random)));
}

TEST(PlanarOccluder, HidesExactlyTheDirectionsThatMeetThePolygonFromBothSides) {
  const auto plane = PlanarOccluder::fit(rectangle(2, 3), 24);
  ASSERT_TRUE(plane);
  std::mt19937 random(1);
  int hidden = 0;
  for (const float height : {0.5f, -1.5f}) {
    const Vec3 position(0.3f, height, -0.4f);
    for (int i = 0; i < 20000; ++i) {
      const Vec3 c = random_direction(random);
      const float t = -position.y / c.y;
      const Vec3 at = position + t * c;
      const bool meets = t > 0 && std::fabs(at.x) < 2 && std::fabs(at.z) < 3;
      const float d = plane->distance(position, c);
      hidden += meets;
      if (std::fabs(d) < 1e-4f) continue;
      ASSERT_EQ(d < 0, meets) << c.x << ' ' << c.y << ' ' << c.z << " from height " << height;
    }
  }
  EXPECT_GT(hidden, 5000);
}

TEST(PlanarOccluder, DistanceIsTheAngleToTheOutline) {
  const auto plane = PlanarOccluder::fit(rectangle(1, 1), 4);
  ASSERT_TRUE(plane);
  // Above the middle of an edge, straight down lies on the outline; a turn away from it is the distance.
  const Vec3 position(1, 2, 0);
  for (const float angle : {-0.2f, -0.05f, 0.f, 0.1f, 0.7f}) {
    const Vec3 c(std::sin(angle), -std::cos(angle), 0);
    EXPECT_NEAR(plane->distance(position, c), angle * 0.70710678f, 2e-6f) << angle;
  }
}

TEST(PlanarOccluder, ALimitOnTheDistanceChangesNothingBelowIt) {
  const auto plane = PlanarOccluder::fit(rectangle(1, 2), 8);
  ASSERT_TRUE(plane);
  std::mt19937 random(2);
  PlanarOccluder::Seen seen;
  plane->see({0.2f, 1, 0.3f}, seen);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 c = random_direction(random);
    const float d = plane->distance({0.2f, 1, 0.3f}, c);
    // Deeper inside than the limit only that is known.
    if (d > -0.1f) {
      EXPECT_FLOAT_EQ(seen.distance(c, 0.1f), std::min(d, 0.1f));
    } else {
      EXPECT_LE(seen.distance(c, 0.1f), -0.0999f);
      EXPECT_GE(seen.distance(c, 0.1f), d);
    }
  }
}

TEST(PlanarOccluder, AlongIsTheWayToThePlane) {
  const auto plane = PlanarOccluder::fit(rectangle(1, 1), 4);
  ASSERT_TRUE(plane);
  EXPECT_FLOAT_EQ(plane->along({0, 2, 0}, {0, -1, 0}), 2.f);
  EXPECT_FLOAT_EQ(plane->along({0, 2, 0}, glm::normalize(Vec3(1, -1, 0))), 2 * std::sqrt(2.f));
  EXPECT_TRUE(std::isinf(plane->along({0, 2, 0}, {0, 1, 0})));
}

TEST(PlanarOccluder, BentOrPiercedMeshesAreNone) {
  std::vector<Vec3> bent = rectangle(1, 1);
  bent[7].y = 0.1f;
  EXPECT_FALSE(PlanarOccluder::fit(bent, 4));
  EXPECT_FALSE(PlanarOccluder::fit(rectangle(1, 1), 3)) << "a hole of a quarter";
  const std::vector<Vec3> line{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {5, 0, 0}};
  EXPECT_FALSE(PlanarOccluder::fit(line, 0));
  EXPECT_FALSE(PlanarOccluder::fit(std::vector<Vec3>(5, Vec3(1)), 0));
}

TEST(PlanarOccluder, AllLightsAtOnceAreAsFarAsOneByOne) {
  const auto plane = PlanarOccluder::fit(rectangle(1, 2), 8);
  ASSERT_TRUE(plane);
  std::mt19937 random(4);
  std::uniform_real_distribution<float> radius(0.01f, 1.2f);
  LightSet lights;
  for (int i = 0; i < 500; ++i) lights.add({random_direction(random), radius(random), Color(1)});
  lights.finish();
  test::on_every_target([&] {
    PlanarOccluder::Seen seen;
    AlignedVector<float> distances(lights.x.size());
    int hidden = 0;
    for (const Vec3& position : {Vec3(0.2f, 0.7f, -0.3f), Vec3(3, -0.2f, 0.5f)}) {
      plane->see(position, seen);
      seen.distances(lights, 0.7f, distances);
      for (std::size_t i = 0; i < lights.count; ++i) {
        const float r_p = 0.7f * lights.r[i], expected = seen.distance(lights.light(i).center, r_p);
        EXPECT_NEAR(distances[i], expected, 1e-6f);
        hidden += expected < r_p;
      }
    }
    EXPECT_GT(hidden, 100);
    EXPECT_LT(hidden, 900);
  });
}

}  // namespace
}  // namespace sightline::square_lights
