// Local lights: patches and fields against formulas; and the whole sphere of texels against its irradiance.
#include "methods/square_lights/source_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "base/math/frame.h"
#include "methods/square_lights/brdf_table.h"
#include "methods/square_lights/hemisphere_disk.h"
#include "methods/square_lights/light_cube.h"

namespace sightline::square_lights {
namespace {

const Context kContext;

std::vector<PatchLight> lights_at(const LocalLight& light, const Vec3& position) {
  std::vector<PatchLight> lights(light.count());
  light.lights_at(position, lights);
  return lights;
}

double solid_angle(std::span<const PatchLight> lights) {
  double sum = 0;
  for (const PatchLight& p : lights) sum += p.light.solid_angle();
  return sum;
}

/// Irradiance of a receiver of given normal, as the method integrates it: pi times what a white Lambert table returns.
double irradiance(std::span<const PatchLight> lights, const Vec3& normal) {
  static const BrdfTable table = BrdfTable::build(Bsdf(Lambert{Color(1)}), 4, kContext);
  const BrdfTable::Slices slices = table.slices({0.3f, 0.1f, 0.9f});
  const Frame3 frame = frame_from_normal(normal);
  double sum = 0;
  for (const PatchLight& p : lights) {
    const Vec2 at = disk_from_direction(frame.to_local(p.light.center));
    sum += static_cast<double>(p.light.solid_angle()) * p.light.radiance.x * table.mean(slices, at, plane_radius(p.light.radius)).x;
  }
  return std::numbers::pi * sum;
}

TEST(LocalLight, RectanglesHaveTheirSolidAngleNearAndFar) {
  // On the axis of a rectangle 2a x 2b at distance d: 4 asin(ab / sqrt((a² + d²)(b² + d²))).
  const RectangleLight shape{{0, 3, 0}, {0.8f, 0, 0}, {0, 0, 0.5f}, Color(2)};
  EXPECT_LT(glm::cross(shape.half_u, shape.half_v).y, 0) << "shines down";
  for (const int patches : {1, 4, 8}) {
    const LocalLight light = LocalLight::rectangle(shape, patches);
    ASSERT_EQ(light.count(), static_cast<std::size_t>(patches));
    for (const double d : {0.05, 0.5, 3.0, 400.0}) {
      const double truth = 4 * std::asin(0.8 * 0.5 / std::sqrt((0.8 * 0.8 + d * d) * (0.5 * 0.5 + d * d)));
      EXPECT_NEAR(solid_angle(lights_at(light, {0, static_cast<float>(3 - d), 0})) / truth, 1, 2e-4) << "distance " << d;
    }
    EXPECT_EQ(solid_angle(lights_at(light, {0.3f, 3.5f, 0.1f})), 0) << "behind it";
    EXPECT_NEAR(glm::length(light.center() - shape.center), 0, 1e-6f);
    EXPECT_NEAR(light.radius(), std::sqrt(0.64f + 0.25f), 1e-5f);
  }
}

TEST(LocalLight, DisksLightAReceiverAsTheFormulaSays) {
  // A parallel receiver on the axis: pi L R² / (R² + d²).
  const DiskLight shape{{1, 2, 3}, {0.5f, 0, 0}, {0, 0, 0.5f}, Color(4)};
  for (const int patches : {1, 4, 9, 16}) {
    const LocalLight light = LocalLight::disk(shape, patches);
    for (const double d : {1.0, 4.0, 30.0}) {
      const double truth = 4 * std::numbers::pi * 0.25 / (0.25 + d * d);
      const double found = irradiance(lights_at(light, {1, static_cast<float>(2 - d), 3}), {0, 1, 0});
      EXPECT_NEAR(found / truth, 1, d < 2 ? 0.03 : 0.01) << "patches " << patches << " distance " << d;
    }
  }
}

TEST(LocalLight, SpheresLightAReceiverAsTheFormulaSays) {
  // Facing the centre: pi L R² / d²; solid angle 2 pi (1 - sqrt(1 - R²/d²)).
  const SphereLight shape{{0, 0, 5}, 2, Color(3)};
  for (const int patches : {1, 4, 25}) {
    const LocalLight light = LocalLight::sphere(shape, patches);
    for (const double d : {2.2, 5.0, 1000.0}) {
      const auto lights = lights_at(light, {0, 0, static_cast<float>(5 - d)});
      EXPECT_NEAR(solid_angle(lights) / (2 * std::numbers::pi * (4 / (d * d)) / (1 + std::sqrt(1 - 4 / (d * d)))), 1, 1e-4);
      EXPECT_NEAR(irradiance(lights, {0, 0, 1}) / (3 * std::numbers::pi * 4 / (d * d)), 1, d < 3 ? 0.05 : 0.01)
          << "patches " << patches << " distance " << d;
    }
    EXPECT_EQ(solid_angle(lights_at(light, {0, 0.5f, 5})), 0) << "within it";
  }
}

std::vector<AreaPatch> sphere_pieces(int rings, float radius) {
  std::vector<AreaPatch> pieces;
  for (int j = 0; j < rings; ++j) {
    for (int i = 0; i < 2 * rings; ++i) {
      const float theta = kPi * (static_cast<float>(j) + 0.5f) / static_cast<float>(rings);
      const float phi = kPi * (static_cast<float>(i) + 0.5f) / static_cast<float>(rings);
      const Vec3 n{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
      const float half = 0.5f * kPi / static_cast<float>(rings) * radius;
      const Vec3 u{-std::sin(phi), std::cos(phi), 0}, v = glm::cross(n, u);
      pieces.push_back({radius * n, half * std::sin(theta) * u, half * v, Color(1, 2, 3)});
    }
  }
  return pieces;
}

TEST(LocalLight, ManyPiecesAreGatheredIntoFew) {
  const std::vector<AreaPatch> pieces = sphere_pieces(24, 0.7f);
  const LocalLight all = LocalLight::pieces(pieces, 5000), few = LocalLight::pieces(pieces, 64);
  EXPECT_EQ(all.count(), 5000u);  // halved instead
  EXPECT_EQ(few.count(), 64u);
  EXPECT_NEAR(few.radius(), 0.7f, 0.02f);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (int i = 0; i < 20; ++i) {
    const Vec3 direction = glm::normalize(Vec3(unit(random), unit(random), unit(random)));
    const float d = 4;
    const double truth = 2 * std::numbers::pi * (1 - std::sqrt(1 - 0.49 / (d * d)));
    EXPECT_NEAR(solid_angle(lights_at(few, d * direction)) / truth, 1, 0.08);
  }
}

TEST(LocalLight, MovesWithTransforms) {
  const LocalLight light = LocalLight::rectangle({{0, 1, 0}, {0.5f, 0, 0}, {0, 0, 0.4f}, Color(2)}, 4);
  Mat4 transform(1);
  transform[0] = Vec4(0, 0, -2, 0), transform[1] = Vec4(0, 2, 0, 0), transform[2] = Vec4(2, 0, 0, 0), transform[3] = Vec4(1, 2, 3, 1);
  const LocalLight moved = light.transformed(transform);
  const Vec3 position{0.3f, -0.8f, 0.2f};
  const auto here = lights_at(light, position), there = lights_at(moved, transform_point(transform, position));
  for (std::size_t i = 0; i < here.size(); ++i) {
    EXPECT_NEAR(here[i].light.radius, there[i].light.radius, 1e-5f);
    EXPECT_NEAR(2 * here[i].distance, there[i].distance, 1e-5f);
    EXPECT_LT(glm::length(glm::normalize(transform_vector(transform, here[i].light.center)) - there[i].light.center), 1e-5f);
  }
  EXPECT_NEAR(moved.radius(), 2 * light.radius(), 1e-5f);
}

TEST(SourceField, AgreesWithPatchesOnTheFly) {
  const LocalLight light = LocalLight::disk({{2, 1, -1}, {0.4f, 0, 0.1f}, {0.02f, -0.3f, 0.1f}, Color(5, 0.3f, 70)}, 4);
  const AlignedVector<PackedPatch> table = bake_source_field(light, kContext);
  EXPECT_EQ(table.size() * sizeof(PackedPatch), source_field_bytes(light));
  const SourceField field(light.center(), light.radius(), light.count(), table);
  std::mt19937 random(8);
  std::uniform_real_distribution<float> unit(-1, 1);
  double worst_far = 0, mean_near = 0;
  int near = 0;
  std::vector<PatchLight> found(light.count());
  for (int i = 0; i < 3000; ++i) {
    const float distance = 0.5f * std::pow(100.f, std::fabs(unit(random)));  // in radii, beyond the last shell too
    const Vec3 position = light.center() + light.radius() * distance * glm::normalize(Vec3(unit(random), unit(random), unit(random)));
    const auto truth = lights_at(light, position);
    field.lights_at(position, found);
    const double all = solid_angle(truth), error = std::fabs(solid_angle(found) - all);
    // Where the disk is seen on edge the little that it shows has a kink.
    const bool facing = all * distance * distance > 0.3;
    if (distance > 2 && facing) {
      worst_far = std::max(worst_far, error / all);
      for (std::size_t k = 0; k < found.size(); ++k) {
        EXPECT_LT(glm::length(found[k].light.center - truth[k].light.center), 0.01f);
        EXPECT_NEAR(found[k].distance / truth[k].distance, 1, 0.01f);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[k].light.radiance[c], truth[k].light.radiance[c], 70.f / 512);
      }
    } else if (facing) {
      mean_near += error / all, ++near;
    }
  }
  EXPECT_LT(worst_far, 0.005);
  EXPECT_LT(mean_near / near, 0.05);
}

TEST(SourceField, IsTheSameForAnyNumberOfThreads) {
  const LocalLight light = LocalLight::rectangle({}, 2);
  Context one, three;
  one.threads = 1, three.threads = 3;
  const auto a = bake_source_field(light, one), b = bake_source_field(light, three);
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(PackedPatch)), 0);
}

TEST(AllTexels, LightALambertSphereAsItsIrradiance) {
  const auto sky = [](const Vec3& d) { return Color(1 + 0.8f * d.y + (glm::dot(d, glm::normalize(Vec3(1, 1, 2))) > 0.96f ? 12.f : 0.f)); };
  const LightCube cube = make_light_cube(sky, 32, 4, kContext);
  const BrdfTable table = BrdfTable::build(Bsdf(Lambert{Color(1)}), 4, kContext);
  const BrdfTable::Slices slices = table.slices({0.3f, 0.1f, 0.9f});
  std::vector<SquareLight> lights;
  for (std::size_t i = 0; i < cube.count(); ++i) lights.push_back({cube.center(i), std::sqrt(cube.solid_angle(i) / 2), cube.texels[i]});
  std::mt19937 random(6);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (int k = 0; k < 12; ++k) {
    const Vec3 normal = glm::normalize(Vec3(unit(random), unit(random), unit(random)));
    const Frame3 frame = frame_from_normal(normal);
    double sum = 0, truth = 0;
    for (const SquareLight& light : lights) {
      const Vec2 p = disk_from_direction(frame.to_local(light.center));
      sum += static_cast<double>(light.solid_angle()) * light.radiance.x * table.mean(slices, p, plane_radius(light.radius)).x;
    }
    for (std::size_t i = 0; i < cube.count(); ++i) {
      truth +=
          static_cast<double>(cube.solid_angle(i)) * cube.texels[i].x * std::max(0.f, glm::dot(cube.center(i), normal)) / std::numbers::pi;
    }
    EXPECT_NEAR(sum / truth, 1, 0.01);
  }
}

}  // namespace
}  // namespace sightline::square_lights
