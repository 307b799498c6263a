#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "methods/square_lights/near_lanes.h"
#include "support/every_target.h"

namespace sightline::square_lights {
namespace {

struct NearFixture {
  std::mt19937 random{3};
  std::uniform_real_distribution<float> uniform{0, 1};
  LightSet lights;
  ReachLanes reach;
  std::vector<float> value;
  AlignedVector<float> may;

  explicit NearFixture(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) lights.add({direction(), 0.02f + 0.8f * uniform(random), Color(1)});
    lights.finish();
    for (std::size_t i = 0; i < lights.x.size(); ++i) {
      const float sine = std::min(0.55f * lights.r[i], 1.f);
      reach.cosine.push_back(1 - 2 * sine * sine), reach.sine.push_back(2 * sine * std::sqrt(1 - sine * sine));
      value.push_back(2 * uniform(random) - 1), may.push_back(uniform(random) < 0.8f ? 1.f : 0.f);
    }
  }
  Vec3 direction() {
    std::normal_distribution<float> normal;
    return glm::normalize(Vec3(normal(random), normal(random), normal(random)));
  }
};

// One light after the other, as the definitions read.
TEST(NearLanes, ActiveLightsAreAboveTheHorizonAndNotHidden) {
  NearFixture f(41);
  test::on_every_target([&] {
    for (const float least : {0.f, -0.7f}) {
      const Vec3 normal = f.direction();
      ActiveLights active;
      find_active(f.lights, normal, 0.7f, f.value, least, active);
      std::vector<std::uint32_t> expected;
      for (std::uint32_t i = 0; i < f.lights.count; ++i) {
        const float r_p = f.lights.r[i] * 0.7f, horizon = 1 + r_p;
        const bool above = 1 - glm::dot(f.lights.light(i).center, normal) < horizon * horizon;
        if (above && f.value[i] > least * r_p) expected.push_back(i);
        EXPECT_EQ(active.on[i] > 0, !expected.empty() && expected.back() == i);
      }
      EXPECT_GT(expected.size(), 5u);
      EXPECT_TRUE(std::ranges::equal(active.indices(), expected));
    }
  });
}

TEST(NearLanes, NearLightsAreThoseWhoseConesMeet) {
  NearFixture f(70);
  const Mat3 turn(Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, 0, 0));
  test::on_every_target([&] {
    for (const float distance : {0.5f, 1.5f, 9.f}) {  // within the sphere, near, far
      OccluderLanes occluder;
      occluder.add(distance * f.direction() + Vec3(1, 2, 3), 1, turn);
      occluder.finish();
      OccluderPlaces places;
      occluder_places(occluder, Vec3(1, 2, 3), places);
      const OccluderCone cone = places.cone(0);
      EXPECT_EQ(cone.inside, distance < 1);
      ActiveLights active;
      find_active(f.lights, f.direction(), 0.7f, f.value, -0.7f, active);
      NearLights near;
      find_near(f.lights, active, f.may, f.reach, cone, turn, near);
      std::size_t count = 0;
      for (const std::uint32_t i : active.indices()) {
        if (!(f.may[i] > 0)) continue;
        const Vec3 c = f.lights.light(i).center;
        const float farthest = distance * (cone.cosine * f.reach.cosine[i] - cone.sine * f.reach.sine[i]);
        const bool away = !cone.inside && f.reach.cosine[i] > 0.1f && glm::dot(c, cone.to) < farthest - 1e-4f;
        const bool close = cone.inside || f.reach.cosine[i] <= 0.1f || glm::dot(c, cone.to) > farthest + 1e-4f;
        ASSERT_TRUE(away || close);
        if (away) continue;
        ASSERT_LT(count, near.count);
        EXPECT_EQ(near.index[count], i);
        EXPECT_EQ(Vec3(near.x[count], near.y[count], near.z[count]), Vec3(c.z, c.x, c.y));
        EXPECT_EQ(near.r[count], f.lights.r[i]);
        ++count;
      }
      EXPECT_EQ(near.count, count);
      if (count == 0) continue;
      for (std::size_t k = count; k < padded(count); ++k) EXPECT_EQ(near.x[k], near.x[count - 1]);
    }
  });
}

}  // namespace
}  // namespace sightline::square_lights
