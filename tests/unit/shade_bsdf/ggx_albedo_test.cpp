#include "shade/ggx_albedo.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shade/fresnel.h"
#include "shade/ggx_albedo_table.h"

namespace sightline {
namespace {

/// Entries are raised by up to kLift so that interpolation does not fall short.
constexpr float kLift = 0.06f, kNoise = 3e-3f;

TEST(GgxAlbedo, TablesHoldTheIntegrals) {
  using namespace ggx_table;
  for (int a = 0; a < kAlphaCount; a += 5) {
    for (int c = 1; c < kCosCount; c += 7) {
      const auto expect_holds = [&](float entry, float integral) {
        EXPECT_GE(entry, integral - kNoise) << "alpha " << alpha_at(a) << ", cos " << cos_at(c);
        EXPECT_LE(entry, integral + kLift + kNoise) << "alpha " << alpha_at(a) << ", cos " << cos_at(c);
      };
      for (int e = 2; e < kEtaCount; e += 3)
        expect_holds(kDielectric[e][a][c],
                     integrate_ggx_dielectric_albedo(cos_at(c), alpha_at(a), eta_at(e), 128) / fresnel_dielectric(cos_at(c), eta_at(e)));
      const Vec2 schlick = integrate_ggx_schlick_albedo(cos_at(c), alpha_at(a), 128);
      expect_holds(kSchlick[a][c][0], schlick.x);
      expect_holds(kSchlick[a][c][1], schlick.y);
    }
  }
}

TEST(GgxAlbedo, InterpolationErrsLittleAndUpwards) {
  for (const float alpha : {0.0015f, 0.01f, 0.07f, 0.2f, 0.5f, 0.9f}) {
    const Ggx ggx(alpha, alpha);
    for (int i = 0; i < 12; ++i) {
      const float cosine = 0.02f + 0.083f * static_cast<float>(i);
      // Only grazing views of polished surfaces vary too fast for the table.
      const float allowance = cosine < 0.1f ? 0.04f : 0.012f;
      const auto expect_near = [&](float table, float integral, float eta) {
        EXPECT_GE(table, integral - kNoise) << "alpha " << alpha << ", cos " << cosine << ", eta " << eta;
        EXPECT_LE(table, integral + allowance) << "alpha " << alpha << ", cos " << cosine << ", eta " << eta;
      };
      for (const float eta : {1.02f, 1.1f, 1.33f, 1.5f, 2.2f})
        expect_near(ggx_dielectric_albedo(cosine, ggx, eta), integrate_ggx_dielectric_albedo(cosine, alpha, eta, 96), eta);
      const Vec2 parts = integrate_ggx_schlick_albedo(cosine, alpha, 96);
      expect_near(ggx_schlick_albedo(Color(0.04f), cosine, ggx).x, 0.04f * parts.x + 0.96f * parts.y, 1.5f);
    }
  }
}

TEST(GgxAlbedo, MeansAreMeansOfTheInterpolant) {
  for (const float alpha : {0.f, 0.03f, 0.4f, 1.f}) {
    const Ggx ggx(alpha, alpha);
    for (const float eta : {1.f, 1.2f, 1.5f, 3.f}) {
      double sum = 0;
      constexpr int kSteps = 4000;
      for (int i = 0; i < kSteps; ++i) {
        const double t = (i + 0.5) / kSteps;
        sum += 4 * t * t * t * ggx_dielectric_albedo(static_cast<float>(t * t), ggx, eta) / kSteps;
      }
      EXPECT_NEAR(ggx_dielectric_mean_albedo(ggx, eta), sum, 2e-4) << alpha << " " << eta;
    }
    double sum = 0;
    constexpr int kSteps = 4000;
    for (int i = 0; i < kSteps; ++i) {
      const double t = (i + 0.5) / kSteps;
      sum += 4 * t * t * t * ggx_schlick_albedo(Color(0.3f), static_cast<float>(t * t), ggx).x / kSteps;
    }
    EXPECT_NEAR(ggx_schlick_mean_albedo(Color(0.3f), ggx).x, sum, 2e-4) << alpha;
  }
}

}  // namespace
}  // namespace sightline
