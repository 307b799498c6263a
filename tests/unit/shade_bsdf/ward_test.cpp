// Ward's lobe where its values are known.
#include "shade/ward.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bsdf_cases.h"
#include "shade/bsdf_albedo.h"
#include "support/chi_square.h"

namespace sightline::test {
namespace {

TEST(Ward, SeenAlongTheNormalTheLobeIsThePublishedOne) {
  // [Ward1992, Eq. 5] and the bounded form differ by cos_h^-4 (wi·h)^-2 against 1 / sqrt(cos_i cos_o): not at all in the mirror direction
  // of the normal, and little near it.
  const Ward ward(Color(0), Color(1), 0.2f, 0.1f);
  EXPECT_NEAR(ward.evaluate(Vec3(0, 0, 1), Vec3(0, 0, 1)).f_cos.x, 1 / (4 * kPi * 0.2f * 0.1f), 1e-4f);
  for (const float phi : {0.f, 0.7f, 1.5f}) {
    const Vec3 wi = direction_at(std::cos(0.1f), phi);
    const Vec3 h = glm::normalize(wi + Vec3(0, 0, 1));
    const float slope_x = h.x / h.z / 0.2f, slope_y = h.y / h.z / 0.1f;
    const float published = std::exp(-slope_x * slope_x - slope_y * slope_y) / (4 * kPi * 0.2f * 0.1f) * wi.z / std::sqrt(wi.z);
    EXPECT_NEAR(ward.evaluate(Vec3(0, 0, 1), wi).f_cos.x, published, 0.02f * published) << phi;
  }
}

TEST(Ward, SamplesOfTheLobeWeighTwiceTheirShareOfTheCosines) {
  const Ward ward(Color(0), Color(0.8f), 0.3f, 0.15f);
  Uniform random(5);
  for (const Vec3& wo : outgoing_directions()) {
    for (int i = 0; i < 200; ++i) {
      const auto s = ward.sample(wo, random.next(), random.next2());
      if (!s) continue;
      const float cos_i = std::fabs(s->wi.z), cos_o = std::fabs(wo.z);
      EXPECT_NEAR(s->weight.x, 0.8f * 2 * cos_i / (cos_i + cos_o), 1e-3f);
    }
  }
}

TEST(Ward, TheLobeReturnsAllThatItReceivesAlongTheNormalWhenNarrow) {
  for (const float alpha : {0.02f, 0.05f}) {
    const Bsdf ward(Ward(Color(0), Color(1), alpha, alpha));
    EXPECT_NEAR(integrate_directional_albedo(ward, Vec3(0, 0, 1)).total().x, 1, 2 * alpha * alpha + 1e-3f) << alpha;
  }
}

TEST(Ward, LooksTheSameTurnedAboutTheNormalOnlyWithEqualSlopes) {
  const auto turned = [](const Vec3& w) { return Vec3(-w.y, w.x, w.z); };
  Uniform random(6);
  const Ward even(Color(0.1f), Color(0.5f), 0.2f, 0.2f), brushed(Color(0.1f), Color(0.5f), 0.05f, 0.5f);
  EXPECT_TRUE(even.is_isotropic());
  EXPECT_FALSE(brushed.is_isotropic());
  int different = 0;
  for (int i = 0; i < 100; ++i) {
    const Vec3 wo = sample_cosine_hemisphere(random.next2()), wi = sample_cosine_hemisphere(random.next2());
    const float a = even.evaluate(wo, wi).f_cos.x, b = even.evaluate(turned(wo), turned(wi)).f_cos.x;
    EXPECT_NEAR(a, b, 1e-4f * a + 1e-6f);
    different += std::fabs(brushed.evaluate(wo, wi).f_cos.x - brushed.evaluate(turned(wo), turned(wi)).f_cos.x) > 0.01f;
  }
  EXPECT_GT(different, 20);
}

TEST(Bsdf, SaysWhetherItIsIsotropic) {
  const auto turned = [](const Vec3& w, float c, float s) { return Vec3(c * w.x - s * w.y, s * w.x + c * w.y, w.z); };
  for (const BsdfCase& c : rough_cases()) {
    Uniform random(7);
    float most = 0;
    for (int i = 0; i < 400; ++i) {
      // Pairs near the mirror direction, where lobes are.
      const Vec3 wo = sample_cosine_hemisphere(random.next2());
      const auto s = c.bsdf.sample(wo, random.next(), random.next2());
      if (!s || s->is_delta || wo.z < 0.1f || std::fabs(s->wi.z) < 0.1f) continue;
      const float angle = 2 * kPi * random.next(), cosine = std::cos(angle), sine = std::sin(angle);
      const float a = c.bsdf.evaluate(wo, s->wi).f_cos.x,
                  b = c.bsdf.evaluate(turned(wo, cosine, sine), turned(s->wi, cosine, sine)).f_cos.x;
      most = std::max(most, std::fabs(a - b) / std::max(a, 1e-3f));
    }
    EXPECT_EQ(c.bsdf.is_isotropic(), most < 0.05f) << c.name << " " << most;
  }
}

}  // namespace
}  // namespace sightline::test
