#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "methods/square_lights/hemisphere_disk.h"

namespace sightline::square_lights {
namespace {

TEST(HemisphereDisk, DirectionsComeBackFromTheWholeSphere) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (int i = 0; i < 20000; ++i) {
    const float z = unit(random), angle = kPi * unit(random), sine = std::sqrt(1 - z * z);
    const Vec3 w{sine * std::cos(angle), sine * std::sin(angle), z};
    const Vec2 p = disk_from_direction(w);
    EXPECT_NEAR(glm::dot(p, p), 1 - z, 1e-6f);
    // Towards the rim, which is all one direction, lengths of p in float say less and less about how close it is.
    EXPECT_LT(glm::length(direction_from_disk(p) - w), 1e-6f + (z < -0.5f ? 1e-6f / std::sqrt(1 + z) : 0.f)) << "z " << z;
  }
}

TEST(HemisphereDisk, AreasAreHalfTheSolidAngles) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> unit(0, 1);
  constexpr float kStep = 4e-3f;
  for (int i = 0; i < 2000; ++i) {
    const float length = 1.3f * std::sqrt(unit(random)), angle = 2 * kPi * unit(random);
    const Vec2 p{length * std::cos(angle), length * std::sin(angle)};
    const Vec3 du = direction_from_disk(p + Vec2(kStep, 0)) - direction_from_disk(p - Vec2(kStep, 0));
    const Vec3 dv = direction_from_disk(p + Vec2(0, kStep)) - direction_from_disk(p - Vec2(0, kStep));
    EXPECT_NEAR(glm::length(glm::cross(du, dv)) / (4 * kStep * kStep), 2, 1e-3f);
  }
}

TEST(HemisphereDisk, HemisphereFillsTheUnitDisk) {
  EXPECT_NEAR(glm::length(disk_from_direction({0.6f, 0.8f, 0})), 1, 1e-6f);
  EXPECT_EQ(disk_from_direction({0, 0, 1}), Vec2(0));
  // A square of half diagonal r has the solid angle 2 r², of which the plane shows half.
  EXPECT_NEAR(2 * plane_radius(0.3f) * plane_radius(0.3f), 0.5f * 2 * 0.3f * 0.3f, 1e-7f);
}

}  // namespace
}  // namespace sightline::square_lights
