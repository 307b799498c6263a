#include "methods/square_lights/sharp_lobe.h"

#include <gtest/gtest.h>

#include <cmath>

#include "methods/square_lights/brdf_table.h"
#include "methods/square_lights/hemisphere_disk.h"

namespace sightline::square_lights {
namespace {

Bsdf metal(float alpha) { return Bsdf(Conductor(Color(0.2f, 0.9f, 1.1f), Color(3.9f, 2.4f, 2.2f), Color(1), Ggx(alpha, alpha))); }

/// Mean of `f` over the square light around c whose edges follow the plane of incidence.
template <class Function>
Color mean_over_square(const Vec3& c, float r, const Vec3& along, Function&& f) {
  constexpr int kPoints = 48;
  const Frame3 frame = frame_from_normal_tangent(c, along);
  const float half = r / std::sqrt(2.f);
  Color sum(0);
  for (int i = 0; i < kPoints * kPoints; ++i) {
    const Vec2 p = half * ((2.f * Vec2(i % kPoints, i / kPoints) + 1.f) / static_cast<float>(kPoints) - 1.f);
    const float s = glm::dot(p, p), k = std::sqrt(1 - s / 4);
    const Vec3 wi = frame.to_world({p.x * k, p.y * k, 1 - s / 2});
    if (wi.z > 0) sum += f(wi);
  }
  return sum / static_cast<float>(kPoints * kPoints);
}

TEST(SharpLobe, MeansAreIntegralsOfItsValue) {
  const SharpLobe lobe = SharpLobe::fit(metal(0.04f));
  ASSERT_FALSE(lobe.empty());
  const Vec3 wo = glm::normalize(Vec3(0.3f, -0.5f, 0.8f));
  const SharpLobe::View view = lobe.view(wo);
  const Color peak = SharpLobe::value(view, view.frame.normal);
  for (const float r : {0.002f, 0.03f, 0.2f}) {
    for (const Vec2& offset : {Vec2(0), Vec2(0.05f, 0.02f), Vec2(-0.02f, -0.1f)}) {
      const Vec3 c = glm::normalize(view.frame.to_world({offset.x, offset.y, 1}));
      const Color truth = mean_over_square(c, r, view.frame.tangent, [&](const Vec3& wi) { return SharpLobe::value(view, wi); });
      EXPECT_NEAR(SharpLobe::mean(view, c, r).y, truth.y, 0.01f * truth.y + 2e-3f * peak.y) << "r " << r;
    }
  }
}

TEST(SharpLobe, IsFoundWhereLobesAreNarrow) {
  EXPECT_TRUE(SharpLobe::fit(Bsdf(Lambert{})).empty());
  EXPECT_TRUE(SharpLobe::fit(metal(0.2f)).empty());
  EXPECT_TRUE(SharpLobe::fit(Bsdf(Phong(Color(0.2f), Color(0.5f), 32))).empty());
  EXPECT_FALSE(SharpLobe::fit(Bsdf(Phong(Color(0.2f), Color(0.5f), 1000))).empty());
  EXPECT_FALSE(SharpLobe::fit(Bsdf(CoatedDiffuse(Color(0.5f), 1.5f, Ggx(0.03f, 0.03f)))).empty());
  // A Phong lobe of exponent n is a Gaussian of sharpness n.
  const SharpLobe::View view = SharpLobe::fit(Bsdf(Phong(Color(0), Color(0.5f), 1000))).view(glm::normalize(Vec3(0, 0.1f, 1)));
  EXPECT_NEAR(view.sharpness_x / 1000, 1, 0.03f);
  EXPECT_NEAR(view.sharpness_y / 1000, 1, 0.03f);
}

TEST(SharpLobe, WithTheRestInTheTableSquaresSeeTheBsdf) {
  const Context context;
  for (const Bsdf& bsdf : {Bsdf(Phong(Color(0.2f), Color(0.5f), 2000)), metal(0.03f)}) {
    const SharpLobe lobe = SharpLobe::fit(bsdf);
    const BrdfTable rest = BrdfTable::build(bsdf, 4, context, &lobe), plain = BrdfTable::build(bsdf, 4, context);
    for (const float angle : {0.2f, 0.71f, 1.1f}) {
      const Vec3 wo{0.6f * std::sin(angle), 0.8f * std::sin(angle), std::cos(angle)};
      const SharpLobe::View view = lobe.view(wo);
      double error = 0, table_error = 0, total = 0;
      for (int i = 0; i < 25; ++i) {
        const Vec3 c =
            glm::normalize(view.frame.to_world({0.03f * static_cast<float>(i % 5 - 2), 0.03f * static_cast<float>(i / 5 - 2), 1}));
        const float r = 0.04f;
        const Vec2 p = disk_from_direction(c);
        const double truth = mean_over_square(c, r, view.frame.tangent, [&](const Vec3& wi) { return bsdf.evaluate(wo, wi).f_cos; }).y;
        const double both = rest.mean(rest.slices(wo), p, plane_radius(r)).y + SharpLobe::mean(view, c, r).y;
        const double alone = plain.mean(plain.slices(wo), p, plane_radius(r)).y;
        error += (both - truth) * (both - truth), table_error += (alone - truth) * (alone - truth), total += truth * truth;
      }
      EXPECT_LT(std::sqrt(error / total), 0.05) << "angle " << angle;
      EXPECT_LT(error, 0.02 * table_error);
    }
  }
}

TEST(SharpLobe, LightsAddUpAsTheirMeans) {
  const SharpLobe lobe = SharpLobe::fit(metal(0.03f));
  const Vec3 wo = glm::normalize(Vec3(0.2f, 0.1f, 1));
  const SharpLobe::View view = lobe.view(wo);
  const Frame3 frame = frame_from_normal(glm::normalize(Vec3(1, 2, 3)));
  LightSet lights;
  const std::array<SquareLight, 2> some{SquareLight{frame.to_world(view.frame.normal), 0.05f, Color(1, 2, 3)},
                                        SquareLight{frame.to_world(glm::normalize(Vec3(-0.15f, -0.1f, 1))), 0.1f, Color(3)}};
  Color expected(0);
  const std::array<float, 16> visible{0.5f, 1};
  for (std::size_t i = 0; i < 2; ++i) {
    lights.add(some[i]);
    expected +=
        some[i].radiance * some[i].solid_angle() * visible[i] * SharpLobe::mean(view, frame.to_local(some[i].center), some[i].radius);
  }
  lights.finish();
  const Color sum = shade_lobe(view, frame, lights, visible);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c] / expected[c], 1, 1e-4f);
}

}  // namespace
}  // namespace sightline::square_lights
