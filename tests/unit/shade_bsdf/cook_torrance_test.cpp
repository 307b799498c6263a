// Cook and Torrance's model where its values are known.
#include "shade/cook_torrance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bsdf_cases.h"
#include "shade/bsdf_albedo.h"
#include "shade/fresnel.h"
#include "support/chi_square.h"

namespace sightline::test {
namespace {

/// D F G / (4 cos_i cos_o) term by term.
float published(const Vec3& wo, const Vec3& wi, float m, float f0) {
  const Vec3 h = glm::normalize(wo + wi);
  const float cos2 = h.z * h.z, tan2 = (1 - cos2) / cos2;
  const float d = std::exp(-tan2 / (m * m)) / (kPi * m * m * cos2 * cos2);
  const float g = std::min({1.f, 2 * h.z * wo.z / glm::dot(wo, h), 2 * h.z * wi.z / glm::dot(wo, h)});
  const float eta = (1 + std::sqrt(f0)) / (1 - std::sqrt(f0));
  return d * g * fresnel_dielectric(glm::dot(wo, h), eta) / (4 * wo.z * wi.z);
}

TEST(CookTorrance, IsTheProductOfItsTerms) {
  Uniform random(3);
  for (const float m : {0.1f, 0.4f, 0.8f}) {
    const CookTorrance model(Color(0), Color(0.7f), m, Color(0.04f, 0.3f, 0.9f));
    for (int i = 0; i < 300; ++i) {
      const Vec3 wo = sample_cosine_hemisphere(random.next2()), wi = sample_cosine_hemisphere(random.next2());
      const Color f_cos = model.evaluate(wo, wi).f_cos;
      const float expected[] = {published(wo, wi, m, 0.04f), published(wo, wi, m, 0.3f), published(wo, wi, m, 0.9f)};
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(f_cos[c], 0.7f * wi.z * expected[c], 2e-3f * f_cos[c] + 1e-6f);
    }
  }
}

TEST(CookTorrance, F0IsWhatAFacetReflectsAlongItsNormal) {
  const Color f0{0.04f, 0.5f, 0.95f};
  const CookTorrance model(Color(0), Color(1), 0.02f, f0);
  const Color albedo = integrate_directional_albedo(Bsdf(model), Vec3(0, 0, 1)).total();
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(albedo[c], f0[c], 2e-3f);
}

TEST(CookTorrance, GroovesThatReflectEverythingLoseOnlyWhatLeavesThemTwice) {
  // With F = 1 a sample weighs G2 / G1 <= 1, and nearly 1 where shadowing is rare.
  const Bsdf smooth(CookTorrance(Color(0), Color(1), 0.1f, Color(1)));
  for (const float cosine : {1.f, 0.7f, 0.4f}) {
    const float albedo = integrate_directional_albedo(smooth, direction_at(cosine, 0.3f)).total().x;
    EXPECT_GT(albedo, 0.96f) << cosine;
    EXPECT_LE(albedo, 1.0001f) << cosine;
  }
}

TEST(CookTorrance, SamplesOfTheLobeNeverWeighMoreThanFresnelLets) {
  const CookTorrance model(Color(0), Color(1), 0.6f, Color(0.9999f));
  Uniform random(4);
  for (const Vec3& wo : outgoing_directions()) {
    for (int i = 0; i < 500; ++i) {
      const auto s = model.sample(wo, random.next(), random.next2());
      EXPECT_LE(s ? s->weight.x : 0.f, 1 + 1e-4f);
    }
  }
}

}  // namespace
}  // namespace sightline::test
