// The GGX lobe over flat emitters: against sums of the BSDF itself over many points of the emitter.
#include "shade/analytic/lobe_quadrature.h"

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "base/math/frame.h"
#include "base/math/vec3_batch.h"
#include "shade/analytic/gauss_rules.h"
#include "support/every_target.h"

namespace sightline {
namespace {

struct Case {
  Vec3 position, normal, geometric_normal, wo;
  AnalyticBsdf form;
};

struct Receivers {
  Vec3Batch position, normal, geometric_normal, wo, integral;
  AnalyticLobesBatch lobes;
  AlignedVector<float> alpha;
  explicit Receivers(const std::vector<Case>& cases) {
    for (Vec3Batch* b : {&position, &normal, &geometric_normal, &wo, &integral}) b->resize(cases.size());
    lobes.resize(cases.size()), alpha.resize(padded(cases.size()));
    for (std::size_t i = 0; i < cases.size(); ++i) {
      const Case& c = cases[i];
      store(position, i, c.position), store(normal, i, c.normal), store(geometric_normal, i, c.geometric_normal), store(wo, i, c.wo);
      lobes.set(i, analytic_lobes(c.form, glm::dot(c.normal, c.wo)));
      alpha[i] = c.form.ggx.alpha().x;
    }
  }
};

/// Sum of f cos (for F = 1) over points of the emitter, in double precision where it matters.
double summed(const FlatSurface& s, const Case& c, int steps) {
  const Frame3 frame = frame_from_normal(c.normal);
  const Vec3 wo = frame.to_local(c.wo);
  double sum = 0, area = glm::length(glm::cross(s.e1, s.e2));
  const bool disk = s.flags & FlatEmitter::kDisk, triangle = s.flags & FlatEmitter::kTriangle;
  for (int i = 0; i < steps; ++i) {
    // Rows; those of a disk by the angle whose sine v is.
    const double t = (i + 0.5) / steps, angle = std::numbers::pi * (t - 0.5);
    const double v = disk ? std::sin(angle) : t, length = disk ? 2 * std::cos(angle) : triangle ? 1 - t : 1;
    const double weight = disk ? length * 0.5 * std::numbers::pi * length : length;
    for (int j = 0; j < steps; ++j) {
      const double u = length * ((j + 0.5) / steps - (disk ? 0.5 : 0.0));
      const Vec3d d = Vec3d(s.origin) + u * Vec3d(s.e1) + v * Vec3d(s.e2) - Vec3d(c.position);
      const double squared = glm::dot(d, d), facing = -glm::dot(d, Vec3d(s.normal));
      const Vec3 direction(d / std::sqrt(squared)), wi = frame.to_local(direction);
      if (!(facing > 0) || wi.z * wo.z <= 0 || glm::dot(direction, c.geometric_normal) <= 0) continue;
      const Vec3 half = glm::normalize(wo + wi) * (wo.z < 0 ? -1.f : 1.f);
      sum +=
          weight * 0.5 * c.form.ggx.distribution(half) * c.form.ggx.shadowing_over_cosine(wo, wi) * facing / (squared * std::sqrt(squared));
    }
  }
  return sum * area / (static_cast<double>(steps) * steps);
}

FlatSurface surface_of(std::uint32_t flags, const Vec3& origin, const Vec3& e1, const Vec3& e2) {
  FlatSurface s;
  s.origin = origin, s.e1 = e1, s.e2 = e2, s.normal = glm::normalize(glm::cross(e1, e2)), s.flags = flags;
  return s;
}

TEST(GaussRules, IntegratePolynomialsOfTheirDegree) {
  for (const float reach : {0.f, 2.f, 3.f, 4.f, 9.f}) {
    const GaussRule& rule = gauss_rule(reach);
    for (std::size_t degree = 0; degree < 2 * rule.count; ++degree) {
      double sum = 0;
      for (std::size_t i = 0; i < rule.count; ++i)
        sum += rule.weight[i] * std::pow(static_cast<double>(rule.node[i]), static_cast<int>(degree));
      EXPECT_NEAR(sum, degree % 2 == 0 ? 2.0 / (static_cast<double>(degree) + 1) : 0.0, 1e-6) << rule.count << " " << degree;
    }
  }
}

TEST(LobeQuadrature, IsTheSumOverTheEmitter) {
  std::mt19937 engine(5);
  const auto uniform = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(engine); };
  for (const std::uint32_t flags :
       {0u, static_cast<std::uint32_t>(FlatEmitter::kTriangle), static_cast<std::uint32_t>(FlatEmitter::kDisk)}) {
    const FlatSurface light = surface_of(flags, {-1.5f, -1.5f, 5}, {0, 3, 0.4f}, {3, 0.2f, 0});
    std::vector<Case> cases;
    for (const float roughness : {0.15f, 0.2f, 0.4f, 0.6f, 1.f}) {
      for (int k = 0; k < 8; ++k) {
        // From above to grazing, towards the mirror direction and away from it.
        const float cosine = k < 4 ? uniform(0.05f, 0.3f) : uniform(0.3f, 1), angle = uniform(0, 2 * kPi);
        const float sine = std::sqrt(1 - cosine * cosine);
        const Vec3 up(0, 0, 1);
        cases.push_back({{uniform(-6, 6), uniform(-6, 6), uniform(0, 2)},
                         up,
                         up,
                         {sine * std::cos(angle), sine * std::sin(angle), cosine},
                         *analytic_form(Bsdf(MetallicRoughness(Color(1), 1, roughness)))});
      }
    }
    Receivers r(cases);
    std::vector<double> truth;
    for (const Case& c : cases) truth.push_back(summed(light, c, c.form.ggx.alpha().x < 0.03f ? 600 : 200));
    test::on_every_target([&] {
      ggx_over_surface(light, {r.position, r.normal, r.geometric_normal, r.wo, r.lobes, r.alpha}, cases.size(), r.integral);
      for (std::size_t i = 0; i < cases.size(); ++i) {
        const double bound = flags != FlatEmitter::kDisk ? 0.005 : r.alpha[i] < 0.03f ? 0.05 : 0.01;
        EXPECT_NEAR(r.integral.x[i], truth[i], bound * truth[i] + 1e-5) << flags << " " << i << " " << r.alpha[i] << " " << cases[i].wo.z;
      }
    });
  }
}

TEST(LobeQuadrature, HorizonsCutTheEmitter) {
  // A wall that goes below the floor, beside surfaces whose facets and shading normals differ.
  const FlatSurface wall = surface_of(0, {2, -2, -1}, {0, 0, 4}, {0, 4, 0});
  ASSERT_LT(wall.normal.x, 0);
  std::vector<Case> cases;
  for (const float roughness : {0.3f, 0.6f, 1.f})
    for (const Vec3& n : {Vec3(0, 0, 1), Vec3(0.3f, 0, 1), Vec3(-0.4f, 0.2f, 1)})
      for (const Vec3& wo : {Vec3(-1, 0.2f, 0.5f), Vec3(0.1f, -0.3f, 1), Vec3(-0.5f, 1, 0.2f)})
        cases.push_back({{0, 0.3f, 0},
                         glm::normalize(n),
                         {0, 0, 1},
                         glm::normalize(wo),
                         *analytic_form(Bsdf(MetallicRoughness(Color(1), 1, roughness)))});
  Receivers r(cases);
  std::vector<double> truth;
  for (const Case& c : cases) truth.push_back(summed(wall, c, 200));
  test::on_every_target([&] {
    ggx_over_surface(wall, {r.position, r.normal, r.geometric_normal, r.wo, r.lobes, r.alpha}, cases.size(), r.integral);
    for (std::size_t i = 0; i < cases.size(); ++i) EXPECT_NEAR(r.integral.x[i], truth[i], 0.03 * truth[i] + 1e-4) << i;
  });
}

TEST(LobeQuadrature, HardPlacesGiveNumbersInRange) {
  const FlatSurface light = surface_of(FlatEmitter::kTwoSided, {0, 0, 1}, {1, 0, 0}, {0, 1, 0});
  std::vector<Case> cases;
  for (const float roughness : {0.15f, 1.f})
    for (const Vec3& wo : {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(0, 0, -1), Vec3(0.8f, 0, -0.6f), Vec3(1e-5f, 1, 0), Vec3(0)})
      for (const float x : {-1e6f, -1.f, 0.f, 0.5f, 1.f})
        for (const float z : {-1e6f, 0.f, 0.999f, 0.999999f, 1.f, 1.5f})
          cases.push_back({{x, 0.5f, z}, {0, 0, 1}, {0, 0, 1}, wo, *analytic_form(Bsdf(MetallicRoughness(Color(1), 1, roughness)))});
  Receivers r(cases);
  test::on_every_target([&] {
    ggx_over_surface(light, {r.position, r.normal, r.geometric_normal, r.wo, r.lobes, r.alpha}, cases.size(), r.integral);
    for (std::size_t i = 0; i < cases.size(); ++i)
      ASSERT_TRUE(r.integral.x[i] >= 0 && r.integral.x[i] <= 1) << i << " " << r.integral.x[i] << " " << cases[i].position.z;
  });
}

}  // namespace
}  // namespace sightline
