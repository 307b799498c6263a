// Rays that leave lights: they follow their densities, and carry the light's power.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "methods/bidirectional/vertex.h"
#include "scene/builtin/parts.h"
#include "support/chi_square.h"
#include "support/studio.h"

namespace sightline {
namespace {

using test::Uniform;

/// A box to have bounds, and one light.
template <class Shape>
std::shared_ptr<const World> world_with(const Shape& shape) {
  Scene scene;
  builtin::add_mesh(scene, builtin::MeshBuilder().box(Vec3(0.5f), Vec3(1)).build("box"), builtin::add_diffuse(scene, "grey", Color(0.5f)));
  scene.lights.push_back({.name = "light", .shape = shape, .node = {}});
  return World::build(scene, {}, Context());
}

std::shared_ptr<const World> world_with_mesh(bool two_sided, bool sphere, bool inward) {
  Scene scene;
  const MaterialId light = builtin::add_emitter(scene, "light", Color(2));
  scene.materials[light.index].emission_two_sided = two_sided;
  if (sphere)
    builtin::add_sphere(scene, "lamp", {1, 2, 3}, 0.5f, light, inward);
  else
    builtin::add_mesh(scene, builtin::MeshBuilder().triangle({0, 0, 0}, {1, 0, 0.5f}, {0.2f, 0.3f, 1}).build("lamp"), light);
  return World::build(scene, {}, Context());
}

std::shared_ptr<const World> world_with_sky() {
  Scene scene;
  builtin::add_mesh(scene, builtin::MeshBuilder().box(Vec3(0.5f), Vec3(1)).build("box"), builtin::add_diffuse(scene, "grey", Color(0.5f)));
  scene.environment = Environment{};
  return World::build(scene, {}, Context());
}

struct Case {
  std::string name;
  std::shared_ptr<const World> world;
  double power;  ///< W, of one channel; 0: not compared
};

std::vector<Case> cases() {
  const double pi = std::numbers::pi;
  const SpotLight spot{.position = {1, 2, 3},
                       .direction = glm::normalize(Vec3(1, -2, 0.5f)),
                       .intensity = Color(2),
                       .inner_angle_rad = 0.5f,
                       .outer_angle_rad = 0.5f};
  std::vector<Case> all = {
      {"point", world_with(PointLight{.position = {1, 2, 3}, .intensity = Color(2)}), 8 * pi},
      {"spot", world_with(spot), 4 * pi * (1 - std::cos(0.5))},
      {"directional", world_with(DirectionalLight{.direction = glm::normalize(Vec3(1, -2, 3)), .irradiance = Color(2)}), 2 * pi * 3},
      {"rectangle",
       world_with(RectangleLight{.center = {1, 2, 3}, .half_u = {0.5f, 0, 0}, .half_v = {0, 0.25f, 0.2f}, .radiance = Color(2)}),
       2 * pi * 4 * 0.5 * std::hypot(0.25, 0.2)},
      {"disk", world_with(DiskLight{.center = {1, 2, 3}, .half_u = {0.5f, 0, 0}, .half_v = {0, 0.25f, 0}, .radiance = Color(2)}),
       2 * pi * pi * 0.125},
      {"sphere", world_with(SphereLight{.center = {1, 2, 3}, .radius = 0.5f, .radiance = Color(2)}), 2 * pi * pi},
      {"triangle", world_with_mesh(false, false, false), 0},
      {"two-sided triangle", world_with_mesh(true, false, false), 0},
      {"ball", world_with_mesh(false, true, false), 2 * pi * pi},
      {"ball from within", world_with_mesh(false, true, true), 2 * pi * pi},
      {"two-sided ball", world_with_mesh(true, true, false), 4 * pi * pi},
      {"sky", world_with_sky(), 4 * pi * pi * 3},
  };
  return all;
}

TEST(Emission, CarriesThePowerOfTheLight) {
  for (const Case& c : cases()) {
    const LightTable& lights = c.world->lights();
    Uniform u(1);
    double sum = 0, squares = 0;
    constexpr int kSamples = 20000;
    for (int i = 0; i < kSamples; ++i) {
      const EmissionSample s = lights.sample_emission(u.next(), u.next2(), u.next2());
      ASSERT_GT(s.pdf.start, 0) << c.name;
      ASSERT_GT(s.pdf.leave, 0) << c.name;
      const double cosine = is_black(s.normal) ? 1 : std::fabs(static_cast<double>(glm::dot(s.normal, s.direction)));
      const double flux =
          static_cast<double>(s.radiance.y) * cosine / (static_cast<double>(s.pdf.start) * static_cast<double>(s.pdf.leave));
      sum += flux, squares += flux * flux;
    }
    const double mean = sum / kSamples, error = std::sqrt(std::max(0.0, squares / kSamples - mean * mean) / kSamples);
    if (c.power > 0) {
      EXPECT_NEAR(mean, c.power, 4 * error + 1e-3 * c.power) << c.name;
    }
  }
}

TEST(Emission, DensitiesAreThoseOfTheSamples) {
  for (const Case& c : cases()) {
    const LightTable& lights = c.world->lights();
    Uniform u(2);
    for (int i = 0; i < 500; ++i) {
      const EmissionSample s = lights.sample_emission(u.next(), u.next2(), u.next2());
      const EmissionPdf pdf = lights.emission_pdf(s.light, s.point, s.direction);
      EXPECT_NEAR(pdf.start / s.pdf.start, 1, 1e-5f) << c.name;
      EXPECT_NEAR(pdf.leave / s.pdf.leave, 1, 1e-3f) << c.name;
      EXPECT_NEAR(glm::length(s.direction), 1, 1e-4f);
    }
  }
}

TEST(Emission, DirectionsFollowTheirDensity) {
  for (const Case& c : cases()) {
    const LightTable& lights = c.world->lights();
    Uniform u(3);
    const Vec2 place = {0.3f, 0.6f};
    const EmissionSample one = lights.sample_emission(0.5f, place, {0.5f, 0.5f});
    if (one.is_infinite) continue;
    const auto result = test::chi_square_directions(
        [&] { return std::optional(lights.sample_emission(0.5f, place, u.next2()).direction); },
        [&](const Vec3& d) { return static_cast<double>(lights.emission_pdf(one.light, one.point, d).leave); },
        {.axis = is_black(one.normal) ? glm::normalize(Vec3(1, -2, 0.5f)) : one.normal, .power = 2, .rows = 24}, 40000);
    EXPECT_GT(result.p_value, 1e-5) << c.name << "\n" << result.table;
  }
}

TEST(Emission, LightFromInfinityCoversTheScene) {
  for (const Case& c : cases()) {
    const LightTable& lights = c.world->lights();
    Uniform u(4);
    const Bounds bounds = c.world->bounds();
    for (int i = 0; i < 500; ++i) {
      const EmissionSample s = lights.sample_emission(u.next(), u.next2(), u.next2());
      if (!s.is_infinite) continue;
      // Behind the whole scene, and within its bounding sphere's shadow.
      const Vec3 from_center = s.point - bounds.center();
      EXPECT_NEAR(glm::dot(from_center, s.direction), -bounds.half_diagonal(), 1e-4f);
      EXPECT_LE(glm::length(from_center + bounds.half_diagonal() * s.direction), bounds.half_diagonal() * 1.0001f);
    }
  }
}

}  // namespace
}  // namespace sightline
