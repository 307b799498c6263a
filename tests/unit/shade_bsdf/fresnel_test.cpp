#include "shade/fresnel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

namespace sightline {
namespace {

TEST(Fresnel, NormalIncidenceIsTheSquaredIndexContrast) {
  for (const float n : {1.f, 1.0001f, 1.33f, 1.5f, 2.4f, 1 / 1.5f}) {
    const float expected = ((n - 1) / (n + 1)) * ((n - 1) / (n + 1));
    EXPECT_NEAR(fresnel_dielectric(1, n), expected, 1e-6) << n;
  }
}

TEST(Fresnel, BrewsterAngleReflectsOneHalfOfThePerpendicularPart) {
  for (const float n : {1.33f, 1.5f, 2.4f}) {
    const float cosine = 1 / std::sqrt(1 + n * n);
    const float perpendicular = (1 - n * n) / (1 + n * n);
    EXPECT_NEAR(fresnel_dielectric(cosine, n), 0.5f * perpendicular * perpendicular, 1e-6) << n;
  }
}

TEST(Fresnel, ReflectsTotallyBeyondTheCriticalAngle) {
  const float critical = std::sqrt(1 - 1 / (1.5f * 1.5f));
  float cos_t = 1;
  EXPECT_EQ(fresnel_dielectric(critical - 1e-3f, 1 / 1.5f, cos_t), 1);
  EXPECT_EQ(cos_t, 0);
  EXPECT_LT(fresnel_dielectric(critical + 1e-3f, 1 / 1.5f), 0.9f);
  EXPECT_EQ(fresnel_dielectric(0, 1.5f), 1);
}

TEST(Fresnel, IsTheSameFromBothSides) {
  for (int i = 1; i <= 100; ++i) {
    const float cosine = static_cast<float>(i) * 0.01f;
    float cos_t;
    const float outside = fresnel_dielectric(cosine, 1.5f, cos_t);
    EXPECT_NEAR(fresnel_dielectric(cos_t, 1 / 1.5f), outside, 1e-4) << cosine;
  }
}

TEST(Fresnel, EqualIndicesReflectNothing) {
  for (int i = 1; i <= 100; ++i) EXPECT_NEAR(fresnel_dielectric(static_cast<float>(i) * 0.01f, 1), 0, 1e-8);
}

TEST(Fresnel, DiffuseReflectanceAgreesWithQuadrature) {
  for (const float n : {1.0005f, 1.01f, 1.1f, 1.33f, 1.5f, 2.f, 3.f}) {
    double sum = 0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
      const double t = (i + 0.5) / kSteps;  // cos = t² resolves the steep rise at grazing angles
      sum += 4 * t * t * t * fresnel_dielectric(static_cast<float>(t * t), n) / kSteps;
    }
    EXPECT_NEAR(fresnel_dielectric_diffuse(n), sum, n < 1.005f ? 3e-3 : 1e-4) << n;
  }
  EXPECT_EQ(fresnel_dielectric_diffuse(1), 0);
}

TEST(Fresnel, ConductorAgreesWithComplexArithmetic) {
  using Complex = std::complex<double>;
  for (const double eta : {0.0, 0.143, 1.5, 3.0}) {
    for (const double k : {0.0, 0.5, 3.98}) {
      for (int i = 1; i <= 50; ++i) {
        const double cosine = i * 0.02;
        const Complex n(eta, k);
        if (std::abs(n) == 0) continue;
        const Complex cos_t = std::sqrt(1.0 - (1 - cosine * cosine) / (n * n));
        const double parallel = std::norm((n * cosine - cos_t) / (n * cosine + cos_t));
        const double perpendicular = std::norm((cosine - n * cos_t) / (cosine + n * cos_t));
        const Color f = fresnel_conductor(static_cast<float>(cosine), Color(static_cast<float>(eta)), Color(static_cast<float>(k)));
        EXPECT_NEAR(f.x, 0.5 * (parallel + perpendicular), 1e-4) << eta << " " << k << " " << cosine;
      }
    }
  }
}

TEST(Fresnel, SchlickMeetsItsEnds) {
  EXPECT_FLOAT_EQ(fresnel_schlick(Color(0.04f), 1).x, 0.04f);
  EXPECT_FLOAT_EQ(fresnel_schlick(Color(0.04f), 0).x, 1);
}

}  // namespace
}  // namespace sightline
