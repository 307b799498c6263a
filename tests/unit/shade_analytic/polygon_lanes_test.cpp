// The vector form of the polygon integral against its definition, on every instruction set.
#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <cmath>
#include <random>

#include "shade/analytic/polygon.h"
#include "support/every_target.h"

namespace sightline {
namespace {

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  float uniform(float low, float high) { return std::uniform_real_distribution<float>(low, high)(engine_); }
  Vec3 direction() {
    const float z = uniform(-1, 1), phi = uniform(0, 2 * kPi), r = std::sqrt(std::max(0.f, 1 - z * z));
    return glm::normalize(Vec3(r * std::cos(phi), r * std::sin(phi), z));
  }

 private:
  std::mt19937 engine_;
};

std::vector<Vec3> random_polygon(Random& random, int kind) {
  const Vec3 centre{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
  const Vec3 e1 = random.direction(), e2 = random.uniform(0.1f, 2) * glm::normalize(glm::cross(e1, random.direction())) + 0.3f * e1;
  if (kind == 0) return {centre, centre + e1, centre + e2};
  if (kind == 1) return {centre, centre + e1, centre + e1 + e2, centre + e2};
  return disk_polygon(centre, e1, e2, kind == 2 ? 5 : 64);
}

struct Points {
  Vec3Batch position, normal;
  std::size_t count = 0;
  explicit Points(std::size_t n) {
    position.resize(n);
    normal.resize(n);
  }
  void add(const Vec3& p, const Vec3& n) {
    position.x[count] = p.x, position.y[count] = p.y, position.z[count] = p.z;
    normal.x[count] = n.x, normal.y[count] = n.y, normal.z[count] = n.z;
    ++count;
  }
  Vec3 p(std::size_t i) const { return {position.x[i], position.y[i], position.z[i]}; }
  Vec3 n(std::size_t i) const { return {normal.x[i], normal.y[i], normal.z[i]}; }
};

TEST(PolygonIrradianceLanes, AgreeWithTheDefinitionNearAndFar) {
  Random random(7);
  for (int kind = 0; kind < 4; ++kind) {
    for (const EmitterSides sides : {EmitterSides::one, EmitterSides::two}) {
      for (const float distance : {0.01f, 0.3f, 1.f, 10.f, 300.f, 1e4f}) {
        const std::vector<Vec3> polygon = random_polygon(random, kind);
        Points points(203);
        // Aimed at the polygon half of the time: else most far points would see it below their horizon or not at all.
        while (points.count < 203) {
          const Vec3 towards = random.direction();
          const Vec3 position = polygon[0] + distance * random.uniform(0.5f, 2) * towards;
          points.add(position, points.count % 2 ? random.direction() : normalize_or(random.direction() - towards, towards));
        }
        test::on_every_target([&] {
          std::vector<float> found(padded(points.count));
          polygon_irradiance(polygon, points.position, points.normal, points.count, found.data(), sides);
          for (std::size_t i = 0; i < points.count; ++i) {
            const double truth = polygon_irradiance(polygon, points.p(i), points.n(i), sides);
            // Rounding is a part of what the polygon would give face to face; close to a corner, of the angle between it and the horizon.
            const double broadside = 1 / std::max(1.0, static_cast<double>(distance) * distance);
            const double closeness = std::max(1.0, 0.1 / distance);
            EXPECT_NEAR(found[i], truth, 1e-5 * truth + 4e-6 * broadside * closeness) << kind << " " << distance << " " << i;
          }
        });
      }
    }
  }
}

TEST(PolygonIrradianceLanes, HardPlacesGiveNumbersInRange) {
  // Corners, edges, interior and plane of the polygon itself, axis-aligned normals in both senses, edges along the horizon.
  const std::vector<Vec3> polygon{{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1}};
  Points points(4096);
  for (const float x : {-1.f, 0.f, 1e-20f, 1e-7f, 0.5f, 1.f, 3.f})
    for (const float y : {-2.f, 0.f, 0.5f, 1.f})
      for (const float z : {1.f, 1.f - 1e-7f, 1.f - 1e-6f, 0.999f, 0.f, -1e8f, 1e15f, 1.001f})
        for (int axis = 0; axis < 3; ++axis)
          for (const float sign : {-1.f, 1.f}) {
            Vec3 n(0);
            n[axis] = sign;
            points.add({x, y, z}, n);
          }
  test::on_every_target([&] {
    for (const EmitterSides sides : {EmitterSides::one, EmitterSides::two}) {
      std::vector<float> found(padded(points.count));
      polygon_irradiance(polygon, points.position, points.normal, points.count, found.data(), sides);
      for (std::size_t i = 0; i < points.count; ++i) {
        ASSERT_TRUE(found[i] >= 0 && found[i] <= 1) << i;
        // A hair from the emitter the angles hang on the last bits of the coordinates.
        const Vec3 p = points.p(i);
        if (p.z != 1 && std::fabs(p.z - 1) < 1e-5f) continue;
        EXPECT_NEAR(found[i], polygon_irradiance(polygon, p, points.n(i), sides), 2e-5) << p.x << " " << p.y << " " << p.z;
      }
    }
  });
}

TEST(PolygonIrradianceLanes, DegeneratePolygonsAreDark) {
  Points points(3);
  for (int i = 0; i < 3; ++i) points.add({0, 0, static_cast<float>(i)}, {0, 0, 1});
  std::vector<float> found(padded(3), -1.f);
  polygon_irradiance(std::vector<Vec3>(4, Vec3(1)), points.position, points.normal, 3, found.data());
  for (const float f : found) EXPECT_EQ(f, 0);
}

}  // namespace
}  // namespace sightline
