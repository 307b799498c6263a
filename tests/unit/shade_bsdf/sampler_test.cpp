// Every sampler against its own density, and every weight against evaluate().
#include <gtest/gtest.h>

#include <cmath>

#include "bsdf_cases.h"
#include "shade/bsdf_albedo.h"
#include "support/chi_square.h"

namespace sightline::test {
namespace {

constexpr double kFamilySignificance = 0.01;

std::optional<Vec3> direction_of(const std::optional<BsdfSample>& s) {
  return s && !s->is_delta ? std::optional<Vec3>(s->wi) : std::nullopt;
}

TEST(BsdfSampler, DirectionsFollowTheDensity) {
  const auto cases = rough_cases();
  const auto directions = outgoing_directions();
  const double significance = sidak(kFamilySignificance, static_cast<int>(cases.size() * directions.size()));
  std::uint32_t seed = 1;
  for (const BsdfCase& c : cases) {
    for (const Vec3& wo : directions) {
      Uniform random(seed++);
      DirectionGrid grid;
      if (c.narrow) grid = {Vec3(-wo.x, -wo.y, wo.z), 3, 24, 12, std::holds_alternative<Dielectric>(c.bsdf.model())};
      const auto result = chi_square_directions(
          [&] {
            const float u_lobe = random.next();
            return direction_of(c.bsdf.sample(wo, u_lobe, random.next2()));
          },
          [&](const Vec3& wi) { return static_cast<double>(c.bsdf.evaluate(wo, wi).pdf); }, grid, 20000);
      EXPECT_GE(result.p_value, significance) << c.name << ", cos " << wo.z << ": chi-square " << result.statistic << " at "
                                              << result.degrees_of_freedom << " degrees of freedom\n"
                                              << result.table;
    }
  }
}

TEST(BsdfSampler, DensityIntegratesToTheChanceOfADirection) {
  constexpr int kCount = 20000;
  std::uint32_t seed = 1000;
  for (const BsdfCase& c : rough_cases()) {
    for (const Vec3& wo : outgoing_directions()) {
      Uniform random(seed++);
      int found = 0;
      for (int i = 0; i < kCount; ++i) {
        const float u_lobe = random.next();
        found += direction_of(c.bsdf.sample(wo, u_lobe, random.next2())).has_value();
      }
      const double frequency = static_cast<double>(found) / kCount;
      const double density = integrate_directional_albedo(c.bsdf, wo, TransportMode::radiance, 1e-4f).density;
      const double deviation = std::sqrt(std::max(density * (1 - density), 1e-9) / kCount);
      EXPECT_NEAR(frequency, density, 4.5 * deviation + 5e-4) << c.name << ", cos " << wo.z;
    }
  }
}

TEST(BsdfSampler, WeightTimesDensityIsTheEvaluatedValue) {
  std::uint32_t seed = 2000;
  for (const BsdfCase& c : rough_cases()) {
    for (const TransportMode mode : {TransportMode::radiance, TransportMode::importance}) {
      for (const Vec3& wo : outgoing_directions()) {
        Uniform random(seed++);
        for (int i = 0; i < 200; ++i) {
          const float u_lobe = random.next();
          const auto s = c.bsdf.sample(wo, u_lobe, random.next2(), mode);
          if (!s || s->is_delta) continue;
          const BsdfEval e = c.bsdf.evaluate(wo, s->wi, mode);
          // The half vector is found anew from rounded directions, which narrow lobes magnify.
          const float tolerance = c.narrow ? 1e-2f : 2e-3f;
          EXPECT_NEAR(s->pdf, e.pdf, tolerance * e.pdf) << c.name << ", cos " << wo.z << ", wi.z " << s->wi.z;
          const Color difference = glm::abs(s->weight * s->pdf - e.f_cos);
          EXPECT_LE(max_component(difference), tolerance * max_component(e.f_cos) + 1e-7f) << c.name << ", cos " << wo.z;
          EXPECT_NEAR(glm::length(s->wi), 1, 1e-5f) << c.name;
        }
      }
    }
  }
}

TEST(BsdfSampler, TransmissionIsWhatCrossesTheSurface) {
  std::uint32_t seed = 3000;
  for (const BsdfCase& c : all_cases()) {
    for (const Vec3& wo : outgoing_directions()) {
      Uniform random(seed++);
      for (int i = 0; i < 200; ++i) {
        const float u_lobe = random.next();
        const auto s = c.bsdf.sample(wo, u_lobe, random.next2());
        if (!s) continue;
        EXPECT_EQ(s->is_transmission, s->wi.z * wo.z < 0) << c.name;
        EXPECT_TRUE(s->is_transmission || s->eta == 1) << c.name;
      }
    }
  }
}

TEST(BsdfSampler, DeltaModelsEvaluateToNothing) {
  for (const BsdfCase& c : delta_cases()) {
    EXPECT_TRUE(c.bsdf.is_delta()) << c.name;
    for (const Vec3& wo : outgoing_directions()) {
      const BsdfEval e = c.bsdf.evaluate(wo, Vec3(-wo.x, -wo.y, wo.z));
      EXPECT_TRUE(is_black(e.f_cos)) << c.name;
      EXPECT_EQ(e.pdf, 0) << c.name;
    }
  }
  for (const BsdfCase& c : rough_cases()) EXPECT_FALSE(c.bsdf.is_delta()) << c.name;
}

TEST(ChiSquare, TailAgreesWithTabulatedValues) {
  EXPECT_NEAR(chi_square_tail(3.841459, 1), 0.05, 1e-6);
  EXPECT_NEAR(chi_square_tail(18.30704, 10), 0.05, 1e-6);
  EXPECT_NEAR(chi_square_tail(135.8067, 100), 0.01, 1e-6);
  EXPECT_NEAR(chi_square_tail(2, 2), std::exp(-1.0), 1e-12);
}

TEST(ChiSquare, NoticesAWrongDensity) {
  Uniform random(7);
  const auto sample = [&] { return std::optional<Vec3>(sample_cosine_hemisphere(random.next2())); };
  const auto right = chi_square_directions(sample, [](const Vec3& w) { return pdf_cosine_hemisphere(w.z); }, {}, 20000);
  EXPECT_GT(right.p_value, 0.01);
  const auto wrong = chi_square_directions(sample, [](const Vec3& w) { return w.z > 0 ? pdf_uniform_hemisphere() : 0.f; }, {}, 20000);
  EXPECT_LT(wrong.p_value, 1e-10);
}

}  // namespace
}  // namespace sightline::test
