// Following every delta lobe is the same as choosing one at random, on average.
#include <gtest/gtest.h>

#include <cmath>

#include "bsdf_cases.h"
#include "support/chi_square.h"

namespace sightline::test {
namespace {

TEST(DeltaLobes, AreWhatSamplesExpect) {
  Uniform random(21);
  constexpr int kChoices = 500;
  for (const BsdfCase& c : all_cases()) {
    for (int k = 0; k < 40; ++k) {
      // Now and then near grazing, where glass seen from inside reflects totally, and straight down.
      Vec3 wo = sample_uniform_sphere(random.next2());
      if (k == 0) wo = {0, 0, 1};
      if (k == 1) wo = direction_at(0.001f, 1);
      for (const TransportMode mode : {TransportMode::radiance, TransportMode::importance}) {
        const DeltaLobes lobes = c.bsdf.delta_lobes(wo, mode);
        ASSERT_LE(lobes.size(), 2u);
        Color expected[2] = {Color(0), Color(0)};
        for (int j = 0; j < kChoices; ++j) {
          const auto s = c.bsdf.sample(wo, (static_cast<float>(j) + 0.5f) / kChoices, random.next2(), mode);
          if (!s || !s->is_delta) continue;
          bool found = false;
          for (std::size_t l = 0; l < lobes.size() && !found; ++l) {
            if (lobes[l].is_transmission != s->is_transmission) continue;
            found = true;
            expected[l] += s->weight / static_cast<float>(kChoices);
            EXPECT_LT(glm::length(lobes[l].wi - s->wi), 1e-6f) << c.name;
            EXPECT_EQ(lobes[l].eta, s->eta) << c.name;
            EXPECT_EQ(lobes[l].pdf, s->pdf) << c.name;
          }
          ASSERT_TRUE(found) << c.name;
        }
        for (std::size_t l = 0; l < lobes.size(); ++l) {
          EXPECT_TRUE(lobes[l].is_delta) << c.name;
          EXPECT_NEAR(glm::length(lobes[l].wi), 1, 1e-5f) << c.name;
          // One choice more or less.
          const float tolerance = 1.1f / kChoices * max_component(lobes[l].weight) / lobes[l].pdf + 1e-5f;
          for (int channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(lobes[l].weight[channel], expected[l][channel], tolerance) << c.name << " " << wo.z << " lobe " << l;
        }
      }
    }
  }
}

TEST(DeltaLobes, SmoothLimitsHaveThem) {
  const Vec3 wo = direction_at(0.6f, 2);
  const auto count = [&](const Bsdf& bsdf) { return bsdf.delta_lobes(wo).size(); };
  EXPECT_EQ(count(Bsdf(Lambert{})), 0u);
  EXPECT_EQ(count(Bsdf(Dielectric(1.5f, Ggx(), false))), 2u);
  EXPECT_EQ(count(Bsdf(Dielectric(1.5f, Ggx(), true))), 2u);
  EXPECT_EQ(count(Bsdf(Dielectric(1.5f, Ggx(0.2f, 0.2f), false))), 0u);
  EXPECT_EQ(count(Bsdf(Dielectric(1, Ggx(), false))), 1u);
  EXPECT_EQ(count(Bsdf(CoatedDiffuse(Color(0.5f), 1.5f, Ggx()))), 1u);
  EXPECT_EQ(count(Bsdf(MetallicRoughness(Color(0.5f), 0, 0))), 1u);
  EXPECT_EQ(count(Bsdf(Conductor())), 1u);
  // Total reflection.
  EXPECT_EQ(Bsdf(Dielectric(1.5f, Ggx(), false)).delta_lobes(direction_at(-0.2f, 1)).size(), 1u);
}

}  // namespace
}  // namespace sightline::test
