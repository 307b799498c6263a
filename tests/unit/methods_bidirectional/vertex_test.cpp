// Scattering from the light is scattering from the eye, read backwards.
#include "methods/bidirectional/vertex.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/chi_square.h"

namespace sightline::bidirectional {
namespace {

std::vector<std::pair<const char*, Bsdf>> bsdfs() {
  const Color tan{0.8f, 0.5f, 0.2f};
  return {
      {"lambert", Bsdf(Lambert{tan})},
      {"mirror", Bsdf(Conductor(Color(0.2f), Color(3.9f), Color(1), Ggx()))},
      {"metal", Bsdf(Conductor(Color(0.2f), Color(3.9f), Color(1), Ggx(0.3f, 0.15f)))},
      {"paint", Bsdf(MetallicRoughness(tan, 0, 0.3f))},
      {"smooth paint", Bsdf(MetallicRoughness(tan, 0, 0))},
      {"glass", Bsdf(Dielectric(1.5f, Ggx(), false))},
      {"frosted glass", Bsdf(Dielectric(1.5f, Ggx(0.3f, 0.2f), false))},
      {"pane", Bsdf(Dielectric(1.5f, Ggx(), true))},
      {"smooth coat", Bsdf(CoatedDiffuse(tan, 1.5f, Ggx()))},
      {"coat", Bsdf(CoatedDiffuse(tan, 1.5f, Ggx(0.2f, 0.2f)))},
      {"phong", Bsdf(Phong(0.5f * tan, Color(0.4f), 20))},
      {"paper", Bsdf(DiffuseTransmission(0.6f * tan, 0.3f * tan))},
  };
}

/// Faces up, with a shading normal tilted by `tilt`.
Surface surface_of(const Bsdf& bsdf, float tilt) {
  Surface s;
  s.geometric_normal = {0, 1, 0};
  s.frame = frame_from_normal_tangent(glm::normalize(Vec3(std::sin(tilt), std::cos(tilt), 0.3f * std::sin(tilt))), {1, 0, 0});
  s.tangent = {1, 0, 0};
  s.bsdf = bsdf;
  s.plain = bsdf.lambert() != nullptr;
  return s;
}

Vec3 on_sphere(test::Uniform& u) { return sample_uniform_sphere(u.next2()); }

TEST(BidirectionalVertex, DeltasFromTheLightAreThoseFromTheEye) {
  for (const auto& [name, bsdf] : bsdfs()) {
    for (const float tilt : {0.f, 0.2f}) {
      const Surface surface = surface_of(bsdf, tilt);
      test::Uniform u(1);
      int deltas = 0;
      for (int i = 0; i < 2000; ++i) {
        const Vec3 wo = on_sphere(u);
        const auto eye = sample_from_eye(surface, wo, u.next(), u.next2());
        if (!eye || !eye->is_delta || !(eye->pdf_reverse > 0)) continue;
        // The light's sampler, come to the same lobe from the other side.
        for (int k = 0; k < 40; ++k) {
          const auto light = sample_from_light(surface, eye->direction, u.next(), u.next2());
          if (!light || !light->is_delta || glm::dot(light->direction, wo) < 0.9999f) continue;
          EXPECT_NEAR(light->pdf / eye->pdf_reverse, 1, 2e-3f) << name;
          EXPECT_NEAR(light->pdf_reverse / eye->pdf, 1, 2e-3f) << name;
          // Flux: f cos of the eye, times the densities' ratio that turns one measure into the other, times the cosine of the way out.
          const float turn = eye->pdf / light->pdf;
          const Color expected = eye->weight * turn * std::fabs(light->direction.y);
          for (int c = 0; c < 3; ++c) EXPECT_NEAR(light->weight[c], expected[c], 3e-3f * expected[c]) << name << " tilt " << tilt;
          ++deltas;
          break;
        }
      }
      if (surface.bsdf.is_delta()) {
        EXPECT_GT(deltas, 200) << name;
      }
    }
  }
}

TEST(BidirectionalVertex, SamplesFromTheLightHaveTheFluxOfTheIntegrand) {
  for (const auto& [name, bsdf] : bsdfs()) {
    for (const float tilt : {0.f, 0.4f}) {
      const Surface surface = surface_of(bsdf, tilt);
      test::Uniform u(2);
      for (int i = 0; i < 3000; ++i) {
        const Vec3 wi = on_sphere(u);
        const auto s = sample_from_light(surface, wi, u.next(), u.next2());
        if (!s || s->is_delta) continue;
        const ScatterEval eval = evaluate_scatter(surface, s->direction, wi);
        const Color expected = eval.f_cos * (std::fabs(s->direction.y) / s->pdf);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(s->weight[c], expected[c], 1e-4f + 1e-3f * expected[c]) << name;
        if (is_black(eval.f_cos)) continue;
        EXPECT_NEAR(eval.pdf_light / s->pdf, 1, 5e-3f) << name;
        EXPECT_EQ(s->crosses, s->direction.y * wi.y < 0);
      }
    }
  }
}

TEST(BidirectionalVertex, ReverseDensitiesAreThoseOfTheOtherSampler) {
  for (const auto& [name, bsdf] : bsdfs()) {
    if (bsdf.is_delta()) continue;
    for (const float tilt : {0.f, 0.3f}) {
      const Surface surface = surface_of(bsdf, tilt);
      const Vec3 w = glm::normalize(Vec3(0.5f, 0.7f, 0.2f));
      test::Uniform u(3);
      const auto delta_free = [&](const std::optional<ScatterSample>& s) -> std::optional<Vec3> {
        return s && !s->is_delta ? std::optional(s->direction) : std::nullopt;
      };
      const test::DirectionGrid grid{.axis = Vec3(-w.x, w.y, -w.z), .power = 2};
      const auto eye = test::chi_square_directions(
          [&] { return delta_free(sample_from_eye(surface, w, u.next(), u.next2())); },
          [&](const Vec3& wi) { return static_cast<double>(evaluate_scatter(surface, w, wi).pdf_eye); }, grid, 40000);
      const auto light = test::chi_square_directions(
          [&] { return delta_free(sample_from_light(surface, w, u.next(), u.next2())); },
          [&](const Vec3& wo) { return static_cast<double>(evaluate_scatter(surface, wo, w).pdf_light); }, grid, 40000);
      EXPECT_GT(eye.p_value, 1e-5) << name << " tilt " << tilt << "\n" << eye.table;
      EXPECT_GT(light.p_value, 1e-5) << name << " tilt " << tilt << "\n" << light.table;
    }
  }
}

TEST(BidirectionalVertex, FramesSeeWhoLooks) {
  test::Uniform u(4);
  for (const bool plain : {false, true}) {
    Surface surface = surface_of(Bsdf(Lambert{}), 1.2f);
    surface.plain = plain;
    for (int i = 0; i < 1000; ++i) {
      const Vec3 w = on_sphere(u);
      const Frame3 frame = frame_seen_from(surface, w);
      EXPECT_GT(glm::dot(frame.normal, w) * w.y, 0);
      EXPECT_GT(frame.normal.y, 0);
      EXPECT_NEAR(glm::length(frame.normal), 1, 1e-4f);
    }
  }
}

}  // namespace
}  // namespace sightline::bidirectional
