#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "methods/square_lights/occluder_field.h"
#include "methods/square_lights/occluder_place.h"
#include "support/every_target.h"

namespace sightline::square_lights {
namespace {

struct PlaceFixture {
  std::mt19937 random{5};
  Vec3 direction() {
    std::normal_distribution<float> normal;
    return glm::normalize(Vec3(normal(random), normal(random), normal(random)));
  }
  float between(float a, float b) { return std::uniform_real_distribution<float>(a, b)(random); }
  Mat3 rotation() {
    const Frame3 f = frame_from_normal_tangent(direction(), direction());
    return {f.tangent, f.bitangent, f.normal};
  }
};

/// Where on the unrolled faces a place is; the same on both sides of a rounded edge between texels.
Vec2 texels(const OccluderPlace& p) { return {static_cast<float>(p.x) + p.fraction_x, static_cast<float>(p.y) + p.fraction_y}; }

// Occluders of several sizes, turned and far and near, with more of them than fit a vector.
TEST(OccluderPlace, VectorsAgreeWithTheScalarDefinition) {
  PlaceFixture f;
  struct Around {
    Vec3 center;
    float radius;
    Mat3 turn;
  };
  std::vector<Around> all;
  OccluderLanes lanes;
  for (int i = 0; i < 37; ++i) {
    all.push_back({f.between(0.1f, 20) * f.direction(), f.between(0.2f, 2), f.rotation()});
    lanes.add(all.back().center, all.back().radius, all.back().turn);
  }
  lanes.finish();
  test::on_every_target([&] {
    OccluderPlaces places;
    for (int k = 0; k < 200; ++k) {
      const Vec3 position = f.between(0, 5) * f.direction();
      occluder_places(lanes, position, places);
      for (std::size_t i = 0; i < all.size(); ++i) {
        const auto& [center, radius, turn] = all[i];
        const OccluderPlace expected = occluder_place(turn * (position - center) / radius), place = places.place(i);
        EXPECT_NEAR(place.rho, expected.rho, 1e-5f * expected.rho);
        EXPECT_NEAR(place.outline, expected.outline, 1e-3f * expected.outline);
        EXPECT_NEAR(place.outline_cosine, expected.outline_cosine, 1e-3f);
        EXPECT_LT(glm::length(place.normal - expected.normal), 1e-5f);
        EXPECT_NEAR(static_cast<float>(place.shell) + place.between, static_cast<float>(expected.shell) + expected.between, 1e-4f);
        EXPECT_GE(place.shell, 0);
        EXPECT_LE(place.shell, kShells - 2);
        if (place.face == expected.face) {
          EXPECT_LT(glm::length(texels(place) - texels(expected)), 2e-3f);
        } else {  // only on the edge between them
          const Vec3 size = glm::abs(expected.normal);
          const float largest = std::max({size.x, size.y, size.z}), least = std::min({size.x, size.y, size.z});
          EXPECT_NEAR(size.x + size.y + size.z - largest - least, largest, 1e-5f);
        }

        const OccluderCone cone = places.cone(i);
        EXPECT_LT(glm::length(cone.to - (center - position)), 1e-5f);
        EXPECT_NEAR(cone.distance, glm::length(center - position), 1e-4f);
        EXPECT_EQ(cone.inside, !(cone.sine < 1));
        if (cone.inside) continue;
        EXPECT_NEAR(cone.sine, radius / cone.distance, 1e-5f);
        EXPECT_NEAR(cone.cosine * cone.cosine + cone.sine * cone.sine, 1, 1e-5f);
      }
    }
  });
}

TEST(OccluderPlace, TheCentreHasAPlaceToo) {
  OccluderLanes lanes;
  lanes.add({1, 2, 3}, 0.5f, Mat3(1));
  lanes.finish();
  test::on_every_target([&] {
    OccluderPlaces places;
    occluder_places(lanes, {1, 2, 3}, places);
    const OccluderPlace place = places.place(0), expected = occluder_place(Vec3(0));
    EXPECT_EQ(place.normal, expected.normal);
    EXPECT_EQ(place.face, expected.face);
    EXPECT_EQ(place.shell, 0);
    EXPECT_EQ(place.between, 0);
    EXPECT_TRUE(places.cone(0).inside);
  });
}

// The turn between the frames of a point and of a table, against the rotation that it stands for.
TEST(OccluderPlace, FramesOfTablesAreTurnedByTheLeastRotation) {
  PlaceFixture f;
  const OccluderField field(Vec3(0), 1, shell_zoom({}), {});
  for (int k = 0; k < 5000; ++k) {
    // Also about the equator of the frames, where their definition changes sides.
    Vec3 out = f.direction();
    if (k % 4 == 0) out = glm::normalize(Vec3(out.x, out.y, 0.02f * out.z));
    const OccluderSamples samples = field.samples(f.between(0.5f, 8) * out);
    const Vec3 n = samples.frame.normal, t = samples.frame.tangent;
    for (std::size_t i = 0; i < 8; ++i) {
      const Frame3 there = frame_from_normal(-shell_direction(static_cast<std::size_t>(samples.table[i])));
      const Vec3 axis = glm::cross(n, there.normal);
      const Vec3 moved = t + glm::cross(axis, t) + glm::cross(axis, glm::cross(axis, t)) / (1 + glm::dot(n, there.normal));
      const float cells = std::hypot(samples.turn_x[i], samples.turn_y[i]);
      ASSERT_GT(cells, 1);
      EXPECT_NEAR(samples.turn_x[i] / cells, glm::dot(moved, there.tangent), 1e-5f);
      EXPECT_NEAR(samples.turn_y[i] / cells, glm::dot(moved, there.bitangent), 1e-5f);
    }
  }
}

}  // namespace
}  // namespace sightline::square_lights
