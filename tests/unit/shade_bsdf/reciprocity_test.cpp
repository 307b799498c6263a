// Helmholtz: light takes the same way back.
#include <gtest/gtest.h>

#include <cmath>

#include "bsdf_cases.h"
#include "support/chi_square.h"

namespace sightline::test {
namespace {

Color value(const Bsdf& bsdf, const Vec3& wo, const Vec3& wi, TransportMode mode) {
  return bsdf.evaluate(wo, wi, mode).f_cos / std::fabs(wi.z);
}

void expect_equal(const Color& a, const Color& b, const std::string& what) {
  for (int channel = 0; channel < 3; ++channel) EXPECT_NEAR(a[channel], b[channel], 2e-3f * std::max(a[channel], 1e-3f)) << what;
}

TEST(Reciprocity, ReflectionIsSymmetric) {
  Uniform random(11);
  for (const BsdfCase& c : rough_cases()) {
    for (int i = 0; i < 300; ++i) {
      const Vec3 wo = sample_uniform_sphere(random.next2());
      Vec3 wi = sample_uniform_sphere(random.next2());
      if (wo.z * wi.z < 0) wi.z = -wi.z;
      for (const TransportMode mode : {TransportMode::radiance, TransportMode::importance})
        expect_equal(value(c.bsdf, wo, wi, mode), value(c.bsdf, wi, wo, mode), c.name);
    }
  }
}

TEST(Reciprocity, TransmittedRadianceScalesWithTheSquaredIndex) {
  constexpr float kEta = 1.5f;
  const Bsdf glass(Dielectric(kEta, Ggx(0.4f, 0.2f), false));
  Uniform random(12);
  int compared = 0;
  for (int i = 0; i < 2000; ++i) {
    Vec3 above = sample_uniform_hemisphere(random.next2());
    Vec3 below = sample_uniform_hemisphere(random.next2());
    below.z = -below.z;
    const Color in = value(glass, above, below, TransportMode::radiance), out = value(glass, below, above, TransportMode::radiance);
    // f(wo, wi) / eta(wi)² is symmetric for radiance [Walter2007]...
    expect_equal(in * kEta * kEta, out, "radiance");
    // ... and importance takes the way of radiance backwards.
    expect_equal(value(glass, above, below, TransportMode::importance), out, "adjoint");
    expect_equal(value(glass, below, above, TransportMode::importance), in, "adjoint");
    compared += in.x > 1e-3f;
  }
  EXPECT_GT(compared, 300);
}

TEST(Reciprocity, SmoothRefractionReturnsOnItsOwnPath) {
  const Bsdf glass(Dielectric(1.5f, Ggx(), false));
  Uniform random(13);
  for (int i = 0; i < 500; ++i) {
    const Vec3 wo = sample_cosine_hemisphere(random.next2());
    if (wo.z < 0.02f) continue;
    const auto in = glass.sample(wo, 0.999999f, Vec2(0.5f));
    ASSERT_TRUE(in && in->is_transmission);
    EXPECT_FLOAT_EQ(in->eta, 1.5f);
    const auto out = glass.sample(in->wi, 0.999999f, Vec2(0.5f));
    ASSERT_TRUE(out && out->is_transmission);
    EXPECT_FLOAT_EQ(out->eta, 1 / 1.5f);
    EXPECT_LT(glm::length(out->wi - wo), 2e-5f / wo.z);
    EXPECT_NEAR(in->pdf, out->pdf, 1e-4f / wo.z);
    EXPECT_NEAR((in->weight * out->weight).x, 1, 1e-5);
    // Snell.
    EXPECT_NEAR(std::hypot(in->wi.x, in->wi.y) * 1.5f, std::hypot(wo.x, wo.y), 1e-5);
  }
}

TEST(Reciprocity, TheUndersideOfReflectorsLooksLikeTheUpperSide) {
  Uniform random(14);
  for (const BsdfCase& c : rough_cases()) {
    if (std::holds_alternative<Dielectric>(c.bsdf.model())) continue;
    for (int i = 0; i < 100; ++i) {
      Vec3 wo = sample_cosine_hemisphere(random.next2()), wi = sample_cosine_hemisphere(random.next2());
      const BsdfEval above = c.bsdf.evaluate(wo, wi);
      wo.z = -wo.z;
      wi.z = -wi.z;
      const BsdfEval below = c.bsdf.evaluate(wo, wi);
      EXPECT_EQ(above.f_cos, below.f_cos) << c.name;
      EXPECT_EQ(above.pdf, below.pdf) << c.name;
    }
  }
}

}  // namespace
}  // namespace sightline::test
