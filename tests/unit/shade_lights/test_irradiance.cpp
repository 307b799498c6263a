// Monte Carlo irradiance of every kind of light against its closed form.
#include <gtest/gtest.h>

#include <cmath>

#include "light_test_scene.h"

namespace sightline {
namespace {

using test::irradiance;
using test::scene_with;
using test::table_of;

const Vec3 kUp{0, 1, 0};

TEST(LightIrradiance, RectangleMatchesLambertsPolygonFormula) {
  // Emits downwards: cross(half_u, half_v) = -y.
  const RectangleLight light{.center = {0.4f, 2, -0.3f}, .half_u = {1, 0.1f, 0}, .half_v = {0, 0.2f, 0.7f}, .radiance = Color(3, 2, 1)};
  ASSERT_LT(glm::cross(light.half_u, light.half_v).y, 0);
  const std::vector<Vec3> corners{light.center - light.half_u - light.half_v, light.center + light.half_u - light.half_v,
                                  light.center + light.half_u + light.half_v, light.center - light.half_u + light.half_v};
  const LightTable table = table_of(scene_with(light));
  for (const Vec3& normal : {kUp, glm::normalize(Vec3(0.3f, 1, 0.2f))}) {
    const double truth = test::polygon_irradiance(corners, Vec3(0), normal);
    const Color e = irradiance(table, Vec3(0), normal);
    EXPECT_NEAR(e.x, 3 * truth, 3e-3 * truth);
    EXPECT_NEAR(e.z, truth, 1e-3 * truth);
  }
  // Nothing behind it.
  EXPECT_EQ(irradiance(table, {0, 4, 0}, -kUp), Color(0));
}

TEST(LightIrradiance, TriangleMatchesLambertsPolygonFormula) {
  const std::vector<Vec3> corners{{-0.5f, 1.5f, -1}, {1, 1, 0.2f}, {-0.7f, 1.2f, 1}};
  const double truth = test::polygon_irradiance(corners, Vec3(0), kUp);
  // One of the two windings faces the origin; two-sided emission is seen from both.
  for (const bool two_sided : {false, true}) {
    const Color one = irradiance(table_of(test::scene_with_mesh(corners, {{0, 1, 2}}, test::emissive(Color(1), two_sided))), Vec3(0), kUp);
    const Color other =
        irradiance(table_of(test::scene_with_mesh(corners, {{0, 2, 1}}, test::emissive(Color(1), two_sided))), Vec3(0), kUp);
    EXPECT_NEAR(one.x, truth, 1e-3 * truth);
    EXPECT_NEAR(other.x, two_sided ? truth : 0, 1e-3 * truth);
  }
}

TEST(LightIrradiance, ParallelDiskMatchesClosedForm) {
  const float r = 0.8f, h = 1.3f;
  const LightTable table = table_of(scene_with(DiskLight{{0, h, 0}, {r, 0, 0}, {0, 0, r}, Color(2)}));
  const float truth = 2 * kPi * r * r / (r * r + h * h);
  EXPECT_NEAR(irradiance(table, Vec3(0), kUp).x, truth, 1e-3f * truth);
}

TEST(LightIrradiance, SphereMatchesClosedForm) {
  for (const float distance : {1.01f, 1.5f, 4.f, 1000.f}) {
    const LightTable table = table_of(scene_with(SphereLight{{0, distance, 0}, 1, Color(2)}));
    const float truth = 2 * kPi / (distance * distance);
    EXPECT_NEAR(irradiance(table, Vec3(0), kUp).x, truth, 1e-3f * truth) << distance;
  }
  // Invisible sphere lights are one-sided: dark inside.
  EXPECT_EQ(irradiance(table_of(scene_with(SphereLight{{0, 0.2f, 0}, 1, Color(2)})), Vec3(0), kUp), Color(0));
}

TEST(LightIrradiance, InsideOfAReversedSphereIsUniform) {
  Scene scene;
  scene.materials.push_back(test::emissive(Color(1.5f)));
  Sphere sphere;
  sphere.radius = 2;
  sphere.reverse_orientation = true;
  sphere.material = MaterialId(std::size_t{0});
  scene.spheres.push_back(sphere);
  const LightTable table = table_of(scene);
  for (const Vec3& p : {Vec3(0), Vec3(0.5f, -1, 0.2f), Vec3(1.3f, 0.9f, -0.2f)}) {
    EXPECT_NEAR(irradiance(table, p, kUp, 512).x, 1.5f * kPi, 2e-3f * 1.5f * kPi);
  }
  EXPECT_EQ(irradiance(table, {0, 0, 5}, {0, 0, -1}), Color(0));
}

TEST(LightIrradiance, PunctualLightsFollowTheirLaws) {
  const Vec3 n = glm::normalize(Vec3(0.2f, 1, 0));
  const Color point = irradiance(table_of(scene_with(PointLight{{0, 2, 0}, Color(8, 4, 0)})), Vec3(0), n, 4);
  EXPECT_NEAR(point.x, 8 / 4.f * n.y, 1e-5f);
  EXPECT_NEAR(point.y, 4 / 4.f * n.y, 1e-5f);
  const Vec3 travel = glm::normalize(Vec3(1, -2, 0));
  const Color sun = irradiance(table_of(scene_with(DirectionalLight{travel, Color(5)})), Vec3(0), n, 4);
  EXPECT_NEAR(sun.x, 5 * -glm::dot(travel, n), 1e-5f);
}

TEST(LightIrradiance, SpotConesFallOffAsTheirFormatsSay) {
  SpotLight spot{
      .position = Vec3(0, 2, 0), .direction = Vec3(0, -1, 0), .intensity = Color(4), .inner_angle_rad = 0.2f, .outer_angle_rad = 0.6f};
  const auto at = [&](float angle) {
    const LightSample s = table_of(scene_with(spot)).sample({2 * std::tan(angle), 0, 0}, kUp, 0, Vec2(0));
    return s.pdf > 0 ? s.radiance.x / s.pdf * s.distance * s.distance : 0.f;
  };
  const float middle = std::acos(0.5f * (std::cos(0.2f) + std::cos(0.6f)));
  const float quarter = std::acos(0.25f * std::cos(0.2f) + 0.75f * std::cos(0.6f));
  EXPECT_NEAR(at(0.1f), 4, 1e-4f);
  EXPECT_NEAR(at(middle), 1, 1e-4f);
  EXPECT_NEAR(at(quarter), 4 / 16.f, 1e-4f);
  EXPECT_EQ(at(0.61f), 0);
  spot.falloff = SpotLight::Falloff::pbrt;
  EXPECT_NEAR(at(0.1f), 4, 1e-4f);
  EXPECT_NEAR(at(middle), 2, 1e-4f);
  EXPECT_NEAR(at(quarter), 4 * (3 / 16.f - 2 / 64.f), 1e-4f);
  EXPECT_EQ(at(0.61f), 0);
  // The power is the integral of the intensity over directions.
  for (const auto falloff : {SpotLight::Falloff::gltf, SpotLight::Falloff::pbrt}) {
    spot.falloff = falloff;
    double integral = 0;
    constexpr int n = 2000;
    for (int i = 0; i < n; ++i) {
      const double angle = 0.6 * (i + 0.5) / n;
      integral += at(static_cast<float>(angle)) * 2 * std::numbers::pi * std::sin(angle) * 0.6 / n;
    }
    EXPECT_NEAR(table_of(scene_with(spot)).power(0), integral, 1e-3 * integral);
  }
}

TEST(LightIrradiance, ConstantEnvironmentGivesPi) {
  Scene scene;
  scene.environment = Environment{};
  scene.environment->scale = Color(1, 2, 3);
  const LightTable table = table_of(scene);
  EXPECT_TRUE(table.has_environment());
  const Color e = irradiance(table, Vec3(0), glm::normalize(Vec3(1, 2, 3)), 512);
  EXPECT_NEAR(e.x, kPi, 2e-3f);
  EXPECT_NEAR(e.z, 3 * kPi, 6e-3f);
}

TEST(LightIrradiance, ManyLightsAddUp) {
  // Every kind at once; the estimate is the sum of the single estimates whatever the probabilities of choice are.
  Scene all;
  all.lights.push_back({"a", PointLight{{0, 2, 1}, Color(1)}, {}});
  all.lights.push_back({"b", RectangleLight{{1, 2, 0}, {0.5f, 0, 0}, {0, 0, 0.5f}, Color(2)}, {}});
  all.lights.push_back({"c", DiskLight{{-1, 1, 0}, {0.5f, 0, 0}, {0, 0, 0.5f}, Color(1)}, {}});
  all.lights.push_back({"d", SphereLight{{-1, 3, 0.5f}, 0.5f, Color(3)}, {}});
  all.lights.push_back({"e", DirectionalLight{{0.1f, -1, 0.1f}, Color(0.5f)}, {}});
  all.lights.push_back({"f", SpotLight{.position = {0, 3, 0}, .direction = {0, -1, 0}, .intensity = Color(5)}, {}});
  double sum = 0, power = 0;
  for (const Light& light : all.lights) {
    Scene single;
    single.lights.push_back(light);
    sum += irradiance(table_of(single), Vec3(0), kUp).x;
  }
  const LightTable table = table_of(all);
  ASSERT_EQ(table.size(), 6u);
  EXPECT_NEAR(irradiance(table, Vec3(0), kUp, 1024).x, sum, 5e-3 * sum);
  // The probability of a delta light is its share of the power.
  for (std::uint32_t i = 0; i < table.size(); ++i) power += table.power(i);
  for (int i = 0; i < 100; ++i) {
    const LightSample s = table.sample(Vec3(0), kUp, (static_cast<float>(i) + 0.5f) / 100, Vec2(0.5f));
    if (s.is_delta) {
      EXPECT_NEAR(s.pdf, table.power(s.light) / power, 1e-6);
    }
  }
}

}  // namespace
}  // namespace sightline
