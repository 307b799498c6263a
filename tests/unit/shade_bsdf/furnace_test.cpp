// Energy: what a surface sends back under uniform light.
#include <gtest/gtest.h>

#include <cmath>

#include "bsdf_cases.h"
#include "shade/bsdf_albedo.h"
#include "support/chi_square.h"

namespace sightline::test {
namespace {

/// Mean and standard error of the sample weights, drawn until the error is small enough.
struct MeanWeight {
  Vec3d mean{0}, error{0};

  MeanWeight(const Bsdf& bsdf, const Vec3& wo, TransportMode mode, std::uint32_t seed) {
    constexpr int kLeast = 10000, kMost = 2000000;
    constexpr double kErrorGoal = 1e-3;
    Uniform random(seed);
    Vec3d sum(0), squares(0);
    for (int n = 1; n <= kMost; ++n) {
      const float u_lobe = random.next();
      const auto s = bsdf.sample(wo, u_lobe, random.next2(), mode);
      if (s) {
        sum += Vec3d(s->weight);
        squares += Vec3d(s->weight) * Vec3d(s->weight);
      }
      if (n % kLeast != 0) continue;
      mean = sum / static_cast<double>(n);
      error = glm::sqrt(glm::max(squares / static_cast<double>(n) - mean * mean, 0.0) / static_cast<double>(n));
      if (glm::max(error.x, glm::max(error.y, error.z)) <= kErrorGoal) break;
    }
  }
};

TEST(Furnace, MeanWeightIsTheDirectionalAlbedo) {
  std::uint32_t seed = 1;
  for (const BsdfCase& c : all_cases()) {
    for (const TransportMode mode : {TransportMode::radiance, TransportMode::importance}) {
      for (const Vec3& wo : outgoing_directions()) {
        const Color albedo = integrate_directional_albedo(c.bsdf, wo, mode, 1e-4f).total();
        const MeanWeight estimate(c.bsdf, wo, mode, seed++);
        for (int channel = 0; channel < 3; ++channel) {
          EXPECT_LE(estimate.error[channel], 1e-3) << c.name << ", cos " << wo.z;
          EXPECT_NEAR(estimate.mean[channel], albedo[channel], 4 * estimate.error[channel] + 1e-4) << c.name << ", cos " << wo.z;
        }
      }
    }
  }
}

TEST(Furnace, NothingReturnsMoreThanItReceives) {
  std::vector<BsdfCase> cases = all_cases();
  for (const float alpha : {0.f, 0.002f, 0.05f, 0.3f, 1.f}) {
    cases.push_back({"white conductor " + std::to_string(alpha), Bsdf(Conductor(Color(0), Color(1), Color(1), Ggx(alpha, alpha)))});
    cases.push_back({"white glass " + std::to_string(alpha), Bsdf(Dielectric(1.5f, Ggx(alpha, alpha), false))});
    cases.push_back({"white coat " + std::to_string(alpha), Bsdf(CoatedDiffuse(Color(1), 1.5f, Ggx(alpha, alpha)))});
    cases.push_back({"white paint " + std::to_string(alpha), Bsdf(MetallicRoughness(Color(1), 0, std::sqrt(alpha)))});
    cases.push_back({"white half metal " + std::to_string(alpha), Bsdf(MetallicRoughness(Color(1), 0.5f, std::sqrt(alpha)))});
  }
  for (const float alpha : {0.01f, 0.1f, 0.5f, 2.f}) {
    cases.push_back({"white ward " + std::to_string(alpha), Bsdf(Ward(Color(0), Color(1), alpha, alpha))});
    cases.push_back({"white brushed ward " + std::to_string(alpha), Bsdf(Ward(Color(0), Color(1), alpha, 0.1f))});
    cases.push_back({"white cook-torrance " + std::to_string(alpha), Bsdf(CookTorrance(Color(0), Color(1), alpha, Color(1)))});
  }
  cases.push_back({"too much ward", Bsdf(Ward(Color(0.9f), Color(0.8f), 0.3f, 0.2f))});
  cases.push_back({"too much cook-torrance", Bsdf(CookTorrance(Color(0.9f), Color(0.8f), 0.3f, Color(0.5f)))});
  cases.push_back({"too much phong", Bsdf(Phong(Color(0.9f), Color(0.8f), 20))});
  cases.push_back({"too much transmission", Bsdf(DiffuseTransmission(Color(0.9f), Color(0.8f)))});
  for (const BsdfCase& c : cases) {
    for (const Vec3& wo : outgoing_directions()) {
      // Importance: radiance is compressed by 1/eta² on its way into glass, and expanded on its way out.
      const Color albedo = integrate_directional_albedo(c.bsdf, wo, TransportMode::importance, 1e-4f).total();
      EXPECT_LE(max_component(albedo), 1 + 2e-3f) << c.name << ", cos " << wo.z;
      EXPECT_GE(std::min(albedo.x, std::min(albedo.y, albedo.z)), 0) << c.name;
    }
  }
}

TEST(Furnace, LosslessSurfacesReturnEverything) {
  const std::vector<BsdfCase> cases{
      {"lambert", Bsdf(Lambert{Color(1)})},
      {"smooth glass", Bsdf(Dielectric(1.5f, Ggx(), false))},
      {"bubble", Bsdf(Dielectric(1 / 1.33f, Ggx(), false))},
      {"thin pane", Bsdf(Dielectric(1.5f, Ggx(), true))},
      {"ideal mirror", Bsdf(Conductor(Color(0), Color(1), Color(1), Ggx()))},
      {"white metal", Bsdf(MetallicRoughness(Color(1), 1, 0))},
      {"diffuse transmission", Bsdf(DiffuseTransmission(Color(0.6f), Color(0.4f)))},
      {"smooth coat over white", Bsdf(CoatedDiffuse(Color(1), 1.5f, Ggx()))},
      {"glTF white, smooth", Bsdf(MetallicRoughness(Color(1), 0, 0))},
  };
  for (const BsdfCase& c : cases) {
    for (const Vec3& wo : outgoing_directions()) {
      const Color albedo = integrate_directional_albedo(c.bsdf, wo, TransportMode::importance, 1e-5f).total();
      for (int channel = 0; channel < 3; ++channel) EXPECT_NEAR(albedo[channel], 1, 1e-4) << c.name << ", cos " << wo.z;
    }
  }
}

TEST(Furnace, PhongIsNormalisedAtNormalIncidence) {
  for (const float exponent : {0.f, 1.f, 30.f, 5000.f}) {
    const Bsdf phong(Phong(Color(0.25f), Color(0.5f), exponent));
    EXPECT_NEAR(integrate_directional_albedo(phong, Vec3(0, 0, 1)).total().x, 0.75f, 1e-4f) << exponent;
  }
}

TEST(Furnace, SingleScatteringLosesWhatTheHeadersSay) {
  const auto kept = [](const Bsdf::Model& model, float cos_theta) {
    return integrate_directional_albedo(Bsdf(model), Vec3(0, 0, cos_theta), TransportMode::importance).total().x;
  };
  const auto conductor = [](float alpha) { return Conductor(Color(0), Color(1), Color(1), Ggx(alpha, alpha)); };
  const auto glass = [](float alpha) { return Dielectric(1.5f, Ggx(alpha, alpha), false); };
  EXPECT_NEAR(kept(conductor(0.1f), 1), 0.99f, 5e-3f);
  EXPECT_NEAR(kept(conductor(0.25f), 1), 0.92f, 5e-3f);
  EXPECT_NEAR(kept(conductor(0.5f), 1), 0.69f, 5e-3f);
  EXPECT_NEAR(kept(conductor(1), 1), 0.31f, 5e-3f);
  EXPECT_NEAR(kept(glass(0.25f), 1), 0.99f, 5e-3f);
  EXPECT_NEAR(kept(glass(0.25f), -1), 0.93f, 5e-3f);
  EXPECT_NEAR(kept(glass(0.5f), 1), 0.97f, 5e-3f);
  EXPECT_NEAR(kept(glass(0.5f), -1), 0.75f, 5e-3f);
}

TEST(Furnace, LambertSamplesHaveNoVariance) {
  const Bsdf bsdf(Lambert{Color(1, 0.5f, 0.25f)});
  Uniform random(3);
  for (int i = 0; i < 1000; ++i) {
    const auto s = bsdf.sample(direction_at(0.3f, 1), random.next(), random.next2());
    ASSERT_TRUE(s);
    EXPECT_EQ(s->weight, Color(1, 0.5f, 0.25f));
  }
}

TEST(Furnace, TintedMirrorReturnsItsTint) {
  const Color tint{0.9f, 0.6f, 0.3f};
  const Bsdf bsdf(Conductor(Color(0), Color(1), tint, Ggx()));
  const auto s = bsdf.sample(direction_at(0.5f, 1), 0.5f, Vec2(0.5f));
  ASSERT_TRUE(s);
  for (int channel = 0; channel < 3; ++channel) EXPECT_NEAR(s->weight[channel], tint[channel], 1e-5);
}

TEST(Furnace, RadianceIsCompressedByTheSquareOfTheIndex) {
  for (const float alpha : {0.f, 0.3f}) {
    const Bsdf glass(Dielectric(1.5f, Ggx(alpha, alpha), false));
    for (const Vec3& wo : outgoing_directions()) {
      const auto radiance = integrate_directional_albedo(glass, wo, TransportMode::radiance);
      const auto importance = integrate_directional_albedo(glass, wo, TransportMode::importance);
      const float eta = wo.z > 0 ? 1.5f : 1 / 1.5f;
      const float scaled = (radiance.transmitted.x + radiance.delta_transmitted.x) * eta * eta;
      EXPECT_NEAR(scaled, importance.transmitted.x + importance.delta_transmitted.x, 2e-4) << alpha << ", cos " << wo.z;
      EXPECT_NEAR(radiance.reflected.x + radiance.delta_reflected.x, importance.reflected.x + importance.delta_reflected.x, 1e-5);
    }
  }
}

}  // namespace
}  // namespace sightline::test
