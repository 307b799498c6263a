// The analytic coat against a random walk between a dielectric interface and a Lambertian base, which is how pbrt-v4 renders one.
#include "shade/coated_diffuse.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bsdf_cases.h"
#include "shade/bsdf_albedo.h"
#include "shade/dielectric.h"
#include "support/chi_square.h"

namespace sightline::test {
namespace {

struct Walk {
  double returned = 0;  ///< fraction of importance that leaves upwards
  double lost = 0;      ///< fraction that the single-scattering interface swallows
};

/// Sends importance in along wo and follows it.
Walk walk(float reflectance, const Dielectric& coat, const Vec3& wo, int walks, std::uint32_t seed) {
  constexpr int kMaxBounces = 200;
  Uniform random(seed);
  Walk result;
  for (int i = 0; i < walks; ++i) {
    double weight = 1;
    Vec3 arriving = wo;  // points away from the coat, towards where the walk came from
    for (int bounce = 0; bounce < kMaxBounces && weight > 1e-6; ++bounce) {
      const float u_lobe = random.next();
      const auto s = coat.sample(arriving, u_lobe, random.next2(), TransportMode::importance);
      result.lost += weight * (s ? 1 - s->weight.x : 1) / walks;
      if (!s) break;
      weight *= s->weight.x;
      if (s->wi.z > 0) {
        result.returned += weight / walks;
        break;
      }
      weight *= reflectance;
      arriving = -sample_cosine_hemisphere(random.next2());
    }
  }
  return result;
}

double analytic_albedo(float reflectance, float eta, const Ggx& ggx, const Vec3& wo) {
  return integrate_directional_albedo(Bsdf(CoatedDiffuse(Color(reflectance), eta, ggx)), wo, TransportMode::radiance, 1e-4f).total().x;
}

TEST(CoatedDiffuse, SmoothCoatAgreesWithARandomWalk) {
  std::uint32_t seed = 1;
  for (const float reflectance : {0.2f, 0.5f, 0.9f})
    for (const float cosine : {1.f, 0.5f, 0.1f})
      EXPECT_NEAR(analytic_albedo(reflectance, 1.5f, Ggx(), direction_at(cosine, 0)),
                  walk(reflectance, Dielectric(1.5f, Ggx(), false), direction_at(cosine, 0), 40000, seed++).returned, 0.01)
          << reflectance << " " << cosine;
}

TEST(CoatedDiffuse, RoughCoatReturnsWhatAWalkReturnsAndAtMostWhatItLoses) {
  std::uint32_t seed = 100;
  for (const float alpha : {0.05f, 0.1f, 0.3f, 0.7f}) {
    const Ggx ggx(alpha, alpha);
    for (const float reflectance : {0.2f, 0.5f, 0.9f}) {
      for (const float cosine : {1.f, 0.5f, 0.1f}) {
        const Walk truth = walk(reflectance, Dielectric(1.5f, ggx, false), direction_at(cosine, 0), 20000, seed++);
        const double analytic = analytic_albedo(reflectance, 1.5f, ggx, direction_at(cosine, 0));
        EXPECT_GE(analytic, truth.returned - 0.01) << "alpha " << alpha << ", reflectance " << reflectance << ", cos " << cosine;
        EXPECT_LE(analytic, truth.returned + truth.lost + 0.01)
            << "alpha " << alpha << ", reflectance " << reflectance << ", cos " << cosine;
        if (alpha <= 0.1f && reflectance <= 0.5f) {
          EXPECT_NEAR(analytic, truth.returned, 0.035) << alpha << " " << reflectance << " " << cosine;
        }
      }
    }
  }
}

TEST(CoatedDiffuse, WithoutContrastIsLambert) {
  const Bsdf coated(CoatedDiffuse(Color(0.6f), 1, Ggx())), lambert(Lambert{Color(0.6f)});
  Uniform random(5);
  for (int i = 0; i < 100; ++i) {
    const Vec3 wo = sample_cosine_hemisphere(random.next2()), wi = sample_cosine_hemisphere(random.next2());
    EXPECT_NEAR(coated.evaluate(wo, wi).f_cos.x, lambert.evaluate(wo, wi).f_cos.x, 1e-6);
  }
}

TEST(CoatedDiffuse, APreparedDirectionChangesNoValue) {
  Uniform random(6);
  for (int i = 0; i < 200; ++i) {
    const Bsdf plain(CoatedDiffuse(Color(0.6f, 0.3f, 0.1f), 1.5f, i % 3 == 0 ? Ggx() : Ggx(0.3f, 0.2f)));
    Vec3 wo = sample_cosine_hemisphere(random.next2()), wi = sample_cosine_hemisphere(random.next2());
    if (i % 2) wo.z = -wo.z, wi.z = -wi.z;
    for (const Vec3& w : {wo, wi}) {
      Bsdf prepared = plain;
      prepared.prepare(w);
      EXPECT_EQ(prepared.evaluate(wo, wi).f_cos, plain.evaluate(wo, wi).f_cos);
      EXPECT_EQ(prepared.evaluate(wo, wi).pdf, plain.evaluate(wo, wi).pdf);
    }
  }
}

}  // namespace
}  // namespace sightline::test
