// Extreme scales, degenerate lights, points on or inside lights: finite answers, and the same light at every scale.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "light_test_scene.h"
#include "support/chi_square.h"

namespace sightline {
namespace {

using test::scene_with;
using test::table_of;

bool is_sane(const LightSample& s) {
  return std::isfinite(s.pdf) && s.pdf >= 0 && is_finite(s.wi) && is_finite(s.radiance) && is_finite(s.point) && is_finite(s.normal) &&
         !std::isnan(s.distance);
}

std::vector<Scene> scaled_scenes(float scale) {
  std::vector<Scene> scenes;
  scenes.push_back(scene_with(RectangleLight{Vec3(0, 2, 0) * scale, Vec3(0.5f, 0, 0) * scale, Vec3(0, 0, 0.5f) * scale, Color(1)}));
  scenes.push_back(scene_with(DiskLight{Vec3(0, 2, 0) * scale, Vec3(0.5f, 0, 0) * scale, Vec3(0, 0, 0.5f) * scale, Color(1)}));
  scenes.push_back(scene_with(SphereLight{Vec3(0, 2, 0) * scale, 0.5f * scale, Color(1)}));
  scenes.push_back(scene_with(PointLight{Vec3(0, 2, 0) * scale, Color(scale * scale)}));
  scenes.push_back(test::scene_with_mesh({Vec3(0, 2, 0) * scale, Vec3(1, 2, 0) * scale, Vec3(0, 2, 1) * scale}, {{0, 1, 2}},
                                         test::emissive(Color(1), true)));
  return scenes;
}

TEST(LightRobustness, IrradianceDoesNotDependOnTheScale) {
  const std::vector<Scene> unit = scaled_scenes(1);
  for (const float scale : {1e-3f, 1e4f, 1e7f}) {
    const std::vector<Scene> scaled = scaled_scenes(scale);
    for (std::size_t i = 0; i < unit.size(); ++i) {
      const float expected = test::irradiance(table_of(unit[i]), Vec3(0), {0, 1, 0}, 32).x;
      EXPECT_GT(expected, 0);
      EXPECT_NEAR(test::irradiance(table_of(scaled[i]), Vec3(0), {0, 1, 0}, 32).x, expected, 1e-4f * expected) << scale << " light " << i;
    }
  }
}

TEST(LightRobustness, PointsOnInsideAndInThePlaneOfLightsGiveFiniteSamples) {
  test::Uniform random(12);
  for (const float scale : {1e-3f, 1.f, 1e7f}) {
    for (const Scene& scene : scaled_scenes(scale)) {
      const LightTable table = table_of(scene);
      for (int i = 0; i < 300; ++i) {
        const float u_pick = random.next();
        const Vec2 u = random.next2();
        // In the plane, at the centre, inside the sphere, on the very point that is sampled.
        for (const Vec3& p : {Vec3(3, 2, 1) * scale, Vec3(0, 2, 0) * scale, Vec3(0.1f, 2.1f, 0) * scale, Vec3(1e-8f, 2, 0) * scale,
                              table.sample(Vec3(0), Vec3(0), u_pick, u).point}) {
          EXPECT_TRUE(is_sane(table.sample(p, Vec3(0), u_pick, u)));
          EXPECT_TRUE(std::isfinite(table.pdf(p, Vec3(0), 0, p, Vec3(0), Vec3(0, 1, 0))));
        }
      }
    }
  }
}

TEST(LightRobustness, DegenerateAndNonFiniteLightsAreNeverChosen) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Scene scene = test::scene_with_mesh({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {nan, 1, 1}}, {{0, 1, 2}, {0, 0, 0}, {0, 1, 3}, {0, 1, 99}},
                                      test::emissive(Color(1)));
  scene.lights.push_back({"flat", RectangleLight{Vec3(0), Vec3(1, 0, 0), Vec3(2, 0, 0), Color(1)}, {}});
  scene.lights.push_back({"nan", PointLight{Vec3(nan), Color(1)}, {}});
  scene.lights.push_back({"inf", RectangleLight{Vec3(0), Vec3(INFINITY, 0, 0), Vec3(0, 0, 1), Color(1)}, {}});
  scene.lights.push_back({"no radius", SphereLight{Vec3(0), 0, Color(1)}, {}});
  scene.lights.push_back({"black", PointLight{Vec3(0, 1, 0), Color(0)}, {}});
  scene.lights.push_back({"negative", PointLight{Vec3(0, 1, 0), Color(-3)}, {}});
  const auto none = table_of(scene);
  test::Uniform random(1);
  for (int i = 0; i < 200; ++i) EXPECT_EQ(none.sample(Vec3(0, 2, 0), Vec3(0), random.next(), random.next2()).pdf, 0);
  // One good light among them is always found.
  scene.lights.push_back({"good", PointLight{Vec3(0, 1, 0), Color(1)}, {}});
  const auto one = table_of(scene);
  for (int i = 0; i < 200; ++i) EXPECT_EQ(one.sample(Vec3(0, 2, 0), Vec3(0), random.next(), random.next2()).pdf, 1);
}

TEST(LightRobustness, EmptySceneHasNoSamples) {
  const LightTable table = table_of(Scene{});
  EXPECT_EQ(table.size(), 0u);
  EXPECT_FALSE(table.has_environment());
  EXPECT_EQ(table.sample(Vec3(0), Vec3(0), 0.5f, Vec2(0.5f)).pdf, 0);
  EXPECT_EQ(table.environment({0, 1, 0}), Color(0));
  EXPECT_EQ(table.environment_pdf(Vec3(0), Vec3(0), {0, 1, 0}), 0);
  EXPECT_EQ(table.emission(0, {}, true), Color(0));
}

TEST(LightRobustness, PointErrorBoundsTheRounding) {
  // Far from the origin, through a rotation: the distance of sampled points from the exact plane stays within the bound.
  const float a = 0.7f;
  Mat4 m(Mat3(Vec3(std::cos(a), std::sin(a), 0), Vec3(-std::sin(a), std::cos(a), 0), Vec3(0, 0, 1)));
  m[3] = Vec4(3e4f, -1e4f, 2e4f, 1);
  const std::vector<Vec3> v{{-5, 0, -3}, {7, 1, 0}, {0, 2, 6}};
  const LightTable table = table_of(test::scene_with_mesh(v, {{0, 1, 2}}, test::emissive(Color(1), true), m));
  std::vector<Vec3d> exact;
  for (const Vec3& p : v) exact.push_back(Vec3d(glm::dmat4(m) * glm::dvec4(p, 1)));
  const Vec3d normal = glm::normalize(glm::cross(exact[1] - exact[0], exact[2] - exact[0]));
  test::Uniform random(3);
  double largest = 0;
  for (int i = 0; i < 10000; ++i) {
    const LightSample s = table.sample(Vec3(0), Vec3(0), 0, random.next2());
    const double off = std::fabs(glm::dot(Vec3d(s.point) - exact[0], normal));
    largest = std::max(largest, off / s.point_error);
    EXPECT_LT(off, s.point_error * (std::fabs(normal.x) + std::fabs(normal.y) + std::fabs(normal.z)));
  }
  EXPECT_GT(largest, 0.02);  // the bound is not absurdly wide
}

}  // namespace
}  // namespace sightline
