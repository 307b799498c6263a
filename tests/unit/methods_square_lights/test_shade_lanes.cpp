#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "methods/square_lights/hemisphere_disk.h"
#include "methods/square_lights/shade_lanes.h"
#include "methods/square_lights/summed_visibility.h"
#include "shade/bsdf.h"

namespace sightline::square_lights {
namespace {

Vec3 direction_from(std::mt19937& random) {
  std::normal_distribution<float> normal;
  return glm::normalize(Vec3(normal(random), normal(random), normal(random)));
}

LightSet random_lights(std::size_t count, std::mt19937& random) {
  std::uniform_real_distribution<float> uniform(0, 1);
  LightSet lights;
  for (std::size_t i = 0; i < count; ++i)
    lights.add({direction_from(random), 0.02f + 0.5f * uniform(random), Color(uniform(random), uniform(random), uniform(random))});
  lights.finish();
  return lights;
}

/// A table that is visible left of a line through the disk, with slack behind it.
AlignedVector<std::int8_t> half_plane_table(float angle, float offset) {
  AlignedVector<std::int8_t> table(kTableCells + kTableSlack);
  for (int y = 0; y < kTableSize; ++y) {
    for (int x = 0; x < kTableSize; ++x) {
      const float px = (2 * static_cast<float>(x) + 1) / kTableSize - 1, py = (2 * static_cast<float>(y) + 1) / kTableSize - 1;
      table[static_cast<std::size_t>(y * kTableSize + x)] = encode_distance(offset - std::cos(angle) * px - std::sin(angle) * py);
    }
  }
  return table;
}

TEST(ShadeLanes, DistancesAreThoseOfTheScalarDefinition) {
  std::mt19937 random(1);
  const LightSet lights = random_lights(203, random);
  const AlignedVector<std::int8_t> a = half_plane_table(0.3f, 0.1f), b = half_plane_table(2, -0.2f);
  ReceiverTables tables;
  tables.count = 2;
  tables.table[0] = a.data(), tables.table[1] = b.data();
  tables.frame[0] = frame_from_normal(direction_from(random)), tables.frame[1] = frame_from_normal(direction_from(random));
  tables.weight[0] = 0.3f, tables.weight[1] = 0.7f;
  const std::size_t n = lights.x.size();
  AlignedVector<float> distance(n), gx(n), gy(n);
  self_distances(tables, lights, distance, gx, gy);
  for (std::size_t i = 0; i < lights.count; ++i) {
    float expected = 0;
    Vec2 gradient(0);
    for (int j = 0; j < 2; ++j) {
      const Vec2 p = disk_from_direction(tables.frame[j].to_local(lights.light(i).center));
      Vec2 own(0);
      expected += tables.weight[j] * distance_at(TableView(tables.table[j], kTableCells), p, own);
      if (j == 0) gradient = own;
    }
    EXPECT_NEAR(distance[i], expected, 1e-4f) << i;
    EXPECT_NEAR(gx[i], gradient.x, 2e-2f) << i;
    EXPECT_NEAR(gy[i], gradient.y, 2e-2f) << i;
  }
}

TEST(ShadeLanes, WithoutTablesNothingIsHidden) {
  std::mt19937 random(2);
  const LightSet lights = random_lights(20, random);
  AlignedVector<float> distance(lights.x.size()), visible(lights.x.size(), 1.f);
  self_distances({}, lights, distance, {}, {});
  for (const Coverage coverage : {Coverage::parallel, Coverage::average, Coverage::gradient})
    multiply_coverage(distance, {}, {}, lights, 0.70710678f, coverage, visible);
  for (std::size_t i = 0; i < lights.count; ++i) EXPECT_EQ(visible[i], 1.f);
}

TEST(ShadeLanes, CoverageIsThatOfTheScalarDefinition) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(-0.4f, 0.4f);
  const LightSet lights = random_lights(100, random);
  const std::size_t n = lights.x.size();
  AlignedVector<float> distance(n), gx(n), gy(n);
  for (std::size_t i = 0; i < n; ++i) distance[i] = uniform(random), gx[i] = uniform(random), gy[i] = uniform(random);
  for (const Coverage coverage : {Coverage::parallel, Coverage::average, Coverage::gradient}) {
    AlignedVector<float> visible(n, 0.5f);
    multiply_coverage(distance, gx, gy, lights, 0.70710678f, coverage, visible);
    for (std::size_t i = 0; i < lights.count; ++i) {
      const float r_p = plane_radius(lights.r[i]);
      const float expected = coverage == Coverage::parallel  ? covered_parallel(distance[i], r_p)
                             : coverage == Coverage::average ? covered_average(distance[i], r_p)
                                                             : covered_gradient(distance[i], {gx[i], gy[i]}, r_p);
      EXPECT_NEAR(visible[i], 0.5f * expected, 1e-6f);
    }
  }
}

TEST(ShadeLanes, RadianceIsTheSumOfMeansOverSquares) {
  Context context;
  std::mt19937 random(4);
  for (const Bsdf& bsdf : {Bsdf(Lambert(Color(0.7f, 0.4f, 0.2f))), Bsdf(Phong(Color(0.3f, 0.2f, 0.1f), Color(0.5f), 60)),
                           Bsdf(Conductor(Color(0.2f), Color(3.9f), Color(1), Ggx(0.15f, 0.5f)))}) {
    const BrdfTable table = BrdfTable::build(bsdf, 2, context);
    const LightSet lights = random_lights(75, random);
    std::vector<float> visible(lights.x.size());
    std::uniform_real_distribution<float> uniform(0, 1);
    for (float& v : visible) v = uniform(random) < 0.3f ? 0.f : uniform(random);
    const Frame3 frame = frame_from_normal(direction_from(random));
    Vec3 wo = direction_from(random);
    wo.z = std::fabs(wo.z);
    const BrdfTable::Slices slices = table.slices(wo);
    Color expected(0);
    for (std::size_t i = 0; i < lights.count; ++i) {
      const SquareLight light = lights.light(i);
      const Vec2 p = disk_from_direction(frame.to_local(light.center));
      // Squares that lie wholly beyond the horizon are not asked about.
      if (glm::length(p) > 1 + plane_radius(light.radius)) continue;
      expected += light.solid_angle() * light.radiance * visible[i] * table.mean(slices, p, plane_radius(light.radius));
    }
    std::size_t lit = 0;
    const Color sum = shade(frame, slices, lights, visible, 0.70710678f, lit);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c], expected[c], 2e-4f * (0.01f + expected[c]));
    EXPECT_GT(lit, 10u);
    EXPECT_LT(lit, lights.count);
  }
}

TEST(ShadeLanes, TurningLightsTurnsTheirCentresAlone) {
  std::mt19937 random(5);
  const LightSet lights = random_lights(33, random);
  const Frame3 frame = frame_from_normal(direction_from(random));
  // Scale does not matter: a frame's directions.
  const Mat3 rotation = 2.5f * Mat3(frame.tangent, frame.bitangent, frame.normal);
  LightSet turned;
  turned.turned_from(lights, rotation);
  for (std::size_t i = 0; i < lights.count; ++i) {
    const Vec3 expected = frame.to_world(lights.light(i).center);
    EXPECT_LT(glm::length(turned.light(i).center - expected), 1e-6f);
    EXPECT_EQ(turned.light(i).radius, lights.light(i).radius);
    EXPECT_EQ(turned.light(i).radiance, lights.light(i).radiance);
  }
}

TEST(SummedVisibility, OfAHalfPlaneIsThePartOfTheSquareOnItsSide) {
  const AlignedVector<std::int8_t> table = half_plane_table(0, 0.25f);  // visible where x < 0.25
  ReceiverTables tables;
  tables.count = 1, tables.table[0] = table.data(), tables.frame[0] = Frame3{}, tables.weight[0] = 1;
  LightSet lights;
  const float r = 0.3f, h = 0.70710678f * plane_radius(r);
  std::vector<float> expected;
  for (const float x : {-0.4f, 0.1f, 0.2f, 0.25f, 0.3f, 0.6f}) {
    lights.add({direction_from_disk({x, 0.1f}), r, Color(1)});
    expected.push_back(std::clamp((0.25f - (x - h)) / (2 * h), 0.f, 1.f));
  }
  lights.finish();
  std::vector<float> visible(lights.x.size(), 1.f);
  summed_visibility(tables, lights, 0.70710678f, visible);
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(visible[i], expected[i], 0.03f) << i;
}

}  // namespace
}  // namespace sightline::square_lights
