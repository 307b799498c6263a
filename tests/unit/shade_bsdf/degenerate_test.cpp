// Directions and parameters at the edge of what exists must give numbers.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "bsdf_cases.h"
#include "shade/material_eval.h"

namespace sightline::test {
namespace {

std::vector<Vec3> evil_directions() {
  std::vector<Vec3> directions{{1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (const float z : {1e-38f, 1e-20f, 1e-7f, 1e-4f, 0.02f, 0.9999999f}) {
    for (const float sign : {1.f, -1.f}) {
      directions.push_back({std::sqrt(1 - z * z), 0, sign * z});
      directions.push_back({-std::sqrt(0.5f * (1 - z * z)), std::sqrt(0.5f * (1 - z * z)), sign * z});
    }
  }
  return directions;
}

std::vector<BsdfCase> evil_cases() {
  std::vector<BsdfCase> cases = all_cases();
  const auto name = [](const char* model, float a, float b) {
    return std::string(model) + " " + std::to_string(a) + " " + std::to_string(b);
  };
  for (const float alpha : {0.f, 1e-4f, 1e-3f, 2e-3f, 0.1f, 1.f}) {
    for (const float eta : {1 / 3.f, 0.999f, 1.f, 1.0001f, 1.0011f, 1.5f, 3.f, 10.f}) {
      cases.push_back({name("dielectric", alpha, eta), Bsdf(Dielectric(eta, Ggx(alpha, alpha), false))});
      cases.push_back({name("thin", alpha, eta), Bsdf(Dielectric(eta, Ggx(alpha, alpha), true))});
      cases.push_back({name("coated", alpha, eta), Bsdf(CoatedDiffuse(Color(1), eta, Ggx(alpha, alpha)))});
    }
    for (const float metallic : {0.f, 1.f})
      cases.push_back({name("metallic", alpha, metallic), Bsdf(MetallicRoughness(Color(1, 0, 0.5f), metallic, std::sqrt(alpha)))});
    cases.push_back({name("ward", alpha, 1), Bsdf(Ward(Color(0.5f), Color(0.5f), alpha, 1))});
    cases.push_back({name("cook-torrance", alpha, 0), Bsdf(CookTorrance(Color(0), Color(1), alpha, Color(0)))});
    cases.push_back({name("cook-torrance", alpha, 1), Bsdf(CookTorrance(Color(0.5f), Color(0.5f), alpha, Color(1)))});
    cases.push_back({name("conductor", alpha, 0), Bsdf(Conductor(Color(0), Color(0), Color(1), Ggx(alpha, alpha)))});
    cases.push_back({name("conductor", alpha, 1), Bsdf(Conductor(Color(0.2f), Color(4), Color(1), Ggx(alpha, 1)))});
  }
  cases.push_back({"black lambert", Bsdf(Lambert{Color(0)})});
  cases.push_back({"black phong", Bsdf(Phong(Color(0), Color(0), 0))});
  cases.push_back({"sharp phong", Bsdf(Phong(Color(0), Color(1), 1e9f))});
  cases.push_back({"black ward", Bsdf(Ward(Color(0), Color(0), 0, 9))});
  cases.push_back({"black cook-torrance", Bsdf(CookTorrance(Color(0), Color(0), 0, Color(0)))});
  cases.push_back({"black transmission", Bsdf(DiffuseTransmission(Color(0), Color(0)))});
  cases.push_back({"black coated", Bsdf(CoatedDiffuse(Color(0), 1, Ggx()))});
  cases.push_back({"black metallic", Bsdf(MetallicRoughness(Color(0), 1, 0))});
  return cases;
}

bool is_sound(const Color& c) { return is_finite(c) && c.x >= 0 && c.y >= 0 && c.z >= 0; }

TEST(DegenerateBsdf, NothingIsEverNegativeOrNotANumber) {
  const auto directions = evil_directions();
  for (const BsdfCase& c : evil_cases()) {
    const Color albedo = c.bsdf.albedo();
    EXPECT_TRUE(is_sound(albedo) && max_component(albedo) <= 1) << c.name;
    for (const Vec3& wo : directions) {
      for (const Vec3& wi : directions) {
        const BsdfEval e = c.bsdf.evaluate(wo, wi);
        EXPECT_TRUE(is_sound(e.f_cos) && std::isfinite(e.pdf) && e.pdf >= 0) << c.name << " evaluate, wo.z " << wo.z << ", wi.z " << wi.z;
      }
      for (const float u0 : {0.f, 0.25f, 0.5f, kOneMinusEpsilon}) {
        for (const float u1 : {0.f, 0.5f, 0.9f, kOneMinusEpsilon}) {
          for (const float u_lobe : {0.f, 0.3f, 0.7f, kOneMinusEpsilon}) {
            const auto s = c.bsdf.sample(wo, u_lobe, Vec2(u0, u1));
            if (!s) continue;
            EXPECT_TRUE(is_sound(s->weight)) << c.name << " weight, wo.z " << wo.z;
            EXPECT_TRUE(std::isfinite(s->pdf) && s->pdf > 0) << c.name << " pdf " << s->pdf << ", wo.z " << wo.z;
            EXPECT_NEAR(glm::length(s->wi), 1, 1e-4) << c.name << ", wo.z " << wo.z;
            EXPECT_TRUE(std::isfinite(s->eta) && s->eta > 0) << c.name;
          }
        }
      }
    }
  }
}

TEST(DegenerateBsdf, DeltaProbabilityIsNeverZero) {
  for (const BsdfCase& c : evil_cases()) {
    for (const Vec3& wo : evil_directions()) {
      const auto s = c.bsdf.sample(wo, kOneMinusEpsilon, Vec2(0.5f));
      if (!s || !s->is_delta) continue;
      EXPECT_GT(s->pdf, 0) << c.name << ", wo.z " << wo.z;
    }
  }
}

TEST(DegenerateBsdf, BsdfIsSmallAndTriviallyCopyable) {
  EXPECT_LE(sizeof(Bsdf), 64u);
  EXPECT_TRUE(std::is_trivially_copyable_v<Bsdf>);
}

}  // namespace
}  // namespace sightline::test
