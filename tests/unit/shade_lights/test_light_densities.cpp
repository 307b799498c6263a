// Samples of lights follow the densities that they carry, and pdf() agrees with sample().
#include <gtest/gtest.h>

#include <cmath>

#include "light_test_scene.h"
#include "support/chi_square.h"

namespace sightline {
namespace {

using test::scene_with;
using test::table_of;

/// Coarse cells: the quadrature would miss the slivers that edges of a flat light cut from fine ones.
const test::DirectionGrid kFlatGrid{Vec3(0, 1, 0), 1, 10, 12};

/// Where a ray from the origin of the test meets the light.
using Intersect = std::function<std::optional<Vec3>(const Vec3& direction)>;

std::optional<Vec2> plane_parameters(const Vec3& direction, const Vec3& position, const Vec3& origin, const Vec3& e1, const Vec3& e2) {
  const Mat3 m{e1, e2, -direction};
  const float determinant = glm::determinant(m);
  if (determinant == 0) return std::nullopt;
  const Vec3 abt = glm::inverse(m) * (position - origin);
  if (abt.z <= 0) return std::nullopt;
  return Vec2(abt);
}

/// Chi-square of directions, the integral of the density, and bitwise agreement of pdf() with sample().
void check_density(const LightTable& table, const Vec3& position, const Intersect& intersect, const test::DirectionGrid& grid) {
  test::Uniform random(11);
  const Vec3 normal(0, 1, 0);
  const auto density = [&](const Vec3& direction) -> double {
    const auto hit = intersect(direction);
    return hit ? table.pdf(position, normal, 0, *hit, Vec3(0), direction) : 0.0;
  };
  const auto draw = [&]() -> std::optional<Vec3> {
    const LightSample s = table.sample(position, normal, random.next(), random.next2());
    if (!(s.pdf > 0)) return std::nullopt;
    EXPECT_EQ(s.pdf, table.pdf(position, normal, s.light, s.point, s.normal, s.wi));
    EXPECT_NEAR(glm::length(s.wi), 1, 1e-5f);
    EXPECT_LT(glm::length(position + s.distance * s.wi - s.point), 1e-5f * (1 + s.distance));
    return s.wi;
  };
  const auto result = test::chi_square_directions(draw, density, grid, 100000);
  EXPECT_GT(result.p_value, 1e-4) << result.table;

  double integral = 0;
  constexpr int n = 700;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const float z = 1 - 2 * (static_cast<float>(j) + 0.5f) / n, phi = 2 * kPi * (static_cast<float>(i) + 0.5f) / n;
      const float r = std::sqrt(1 - z * z);
      integral += density({r * std::cos(phi), z, r * std::sin(phi)}) * 4 * std::numbers::pi / (static_cast<double>(n) * n);
    }
  }
  EXPECT_NEAR(integral, 1, 0.01);
}

TEST(LightDensity, Rectangle) {
  const RectangleLight light{{0.4f, 1.2f, -0.3f}, {1, 0.1f, 0}, {0, 0.2f, 0.7f}, Color(1)};
  const Intersect intersect = [&](const Vec3& d) -> std::optional<Vec3> {
    const auto p = plane_parameters(d, Vec3(0), light.center, light.half_u, light.half_v);
    if (!p || std::fabs(p->x) > 1 || std::fabs(p->y) > 1) return std::nullopt;
    return light.center + p->x * light.half_u + p->y * light.half_v;
  };
  check_density(table_of(scene_with(light)), Vec3(0), intersect, kFlatGrid);
}

TEST(LightDensity, Disk) {
  const DiskLight light{{0.4f, 1.2f, -0.3f}, {1, 0.1f, 0}, {0.3f, 0.2f, 0.7f}, Color(1)};
  const Intersect intersect = [&](const Vec3& d) -> std::optional<Vec3> {
    const auto p = plane_parameters(d, Vec3(0), light.center, light.half_u, light.half_v);
    if (!p || glm::length(*p) > 1) return std::nullopt;
    return light.center + p->x * light.half_u + p->y * light.half_v;
  };
  check_density(table_of(scene_with(light)), Vec3(0), intersect, kFlatGrid);
}

TEST(LightDensity, Triangle) {
  const std::vector<Vec3> v{{-0.5f, 1.5f, -1}, {1, 1, 0.2f}, {-0.7f, 1.2f, 1}};
  const Intersect intersect = [&](const Vec3& d) -> std::optional<Vec3> {
    const auto p = plane_parameters(d, Vec3(0), v[0], v[1] - v[0], v[2] - v[0]);
    if (!p || p->x < 0 || p->y < 0 || p->x + p->y > 1) return std::nullopt;
    return v[0] + p->x * (v[1] - v[0]) + p->y * (v[2] - v[0]);
  };
  check_density(table_of(test::scene_with_mesh(v, {{0, 1, 2}}, test::emissive(Color(1), true))), Vec3(0), intersect, kFlatGrid);
}

Intersect sphere_hit(const Vec3& center, float radius, const Vec3& position) {
  return [=](const Vec3& d) -> std::optional<Vec3> {
    const double along = glm::dot(Vec3d(center - position), Vec3d(d));
    const Vec3d off = Vec3d(center - position) - along * Vec3d(d);
    const double rest = static_cast<double>(radius) * radius - glm::dot(off, off);
    if (rest < 0) return std::nullopt;
    const double near = along - std::sqrt(rest), far = along + std::sqrt(rest);
    if (far <= 0) return std::nullopt;
    return position + static_cast<float>(near > 0 ? near : far) * d;
  };
}

TEST(LightDensity, SphereFromOutside) {
  for (const float distance : {1.02f, 1.6f, 3.f}) {
    const SphereLight light{{0.3f, distance, 0.1f}, 1, Color(1)};
    check_density(table_of(scene_with(light)), Vec3(0), sphere_hit(light.center, 1, Vec3(0)), {glm::normalize(light.center)});
  }
}

TEST(LightDensity, SphereFromInside) {
  Scene scene;
  scene.materials.push_back(test::emissive(Color(1), true));
  Sphere sphere;
  sphere.center = {0.3f, 0.2f, 0.1f};
  sphere.material = MaterialId(std::size_t{0});
  scene.spheres.push_back(sphere);
  check_density(table_of(scene), Vec3(0), sphere_hit(sphere.center, 1, Vec3(0)), {Vec3(0, 1, 0)});
}

TEST(LightDensity, OneSidedLightsHaveNoDensityFromBehind) {
  const RectangleLight light{{0, 1, 0}, {1, 0, 0}, {0, 0, 1}, Color(1)};
  const LightTable table = table_of(scene_with(light));
  EXPECT_GT(table.pdf(Vec3(0), Vec3(0), 0, light.center, Vec3(0), {0, 1, 0}), 0);
  EXPECT_EQ(table.pdf({0, 2, 0}, Vec3(0), 0, light.center, Vec3(0), {0, -1, 0}), 0);
  EXPECT_EQ(table.sample({0, 2, 0}, Vec3(0), 0, {0.2f, 0.3f}).pdf, 0);
  EXPECT_EQ(table.pdf(Vec3(0), Vec3(0), 7, light.center, Vec3(0), {0, 1, 0}), 0);
}

TEST(LightDensity, EveryKindAgreesBitForBitBetweenSampleAndPdf) {
  Scene scene = test::scene_with_mesh({{-0.5f, 1.5f, -1}, {1, 1, 0.2f}, {-0.7f, 1.2f, 1}, {2, 2, 2}}, {{0, 1, 2}, {1, 2, 3}},
                                      test::emissive(Color(1), true));
  scene.lights.push_back({"r", RectangleLight{{1, 2, 0}, {0.5f, 0, 0}, {0, 0, 0.5f}, Color(2)}, {}});
  scene.lights.push_back({"s", SphereLight{{-1, 3, 0.5f}, 0.5f, Color(3)}, {}});
  scene.environment = Environment{};
  const LightTable table = table_of(scene);
  test::Uniform random(4);
  int seen = 0;
  for (int i = 0; i < 10000; ++i) {
    const Vec3 p = 4.f * Vec3(random.next(), random.next(), random.next()) - 2.f;
    const LightSample s = table.sample(p, Vec3(0), random.next(), random.next2());
    if (!(s.pdf > 0)) continue;
    ++seen;
    EXPECT_EQ(s.pdf, table.pdf(p, Vec3(0), s.light, s.point, s.normal, s.wi));
    if (std::isinf(s.distance)) {
      EXPECT_EQ(s.pdf, table.environment_pdf(p, Vec3(0), s.wi));
    }
  }
  EXPECT_GT(seen, 7000);
}

}  // namespace
}  // namespace sightline
