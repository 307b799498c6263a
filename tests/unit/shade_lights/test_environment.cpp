#include <gtest/gtest.h>

#include <cmath>

#include "base/core/error.h"
#include "light_test_scene.h"
#include "shade/lights/environment_light.h"
#include "shade/lights/environment_map.h"
#include "support/chi_square.h"

namespace sightline {
namespace {

using Mapping = EnvironmentMapping;
constexpr Mapping kMappings[] = {Mapping::latlong, Mapping::angular, Mapping::octahedral};

std::shared_ptr<const Image> picture(int width, int height, const std::function<Color(int, int)>& color) {
  Image image{width, height, 3, Image::Floats{}};
  auto& values = std::get<Image::Floats>(image.data);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Color c = color(x, y);
      values.insert(values.end(), {c.x, c.y, c.z});
    }
  }
  return std::make_shared<const Image>(std::move(image));
}
std::shared_ptr<const Image> bright_texel(int width, int height, int bx, int by) {
  return picture(width, height, [=](int x, int y) { return Color(x == bx && y == by ? 1.f : 0.f); });
}
Environment environment_of(std::shared_ptr<const Image> image, Mapping mapping) {
  Environment e;
  e.image = std::move(image);
  e.mapping = mapping;
  return e;
}
EnvironmentLight light_of(std::shared_ptr<const Image> image, Mapping mapping) {
  return {environment_of(std::move(image), mapping), Context{}};
}

TEST(EnvironmentMapping, KnownDirectionsStandWhereTheConventionsSay) {
  const auto expect = [](Mapping mapping, const Vec3& d, const Vec2& uv) {
    const Vec2 got = environment_uv(mapping, d);
    EXPECT_NEAR(got.x, uv.x, 1e-5f) << d.x << " " << d.y << " " << d.z;
    EXPECT_NEAR(got.y, uv.y, 1e-5f) << d.x << " " << d.y << " " << d.z;
  };
  expect(Mapping::latlong, {0, 0, -1}, {0.5f, 0.5f});
  expect(Mapping::latlong, {1, 0, 0}, {0.75f, 0.5f});
  expect(Mapping::latlong, {-1, 0, 0}, {0.25f, 0.5f});
  EXPECT_NEAR(environment_uv(Mapping::latlong, {0, 1, 0}).y, 0, 1e-6f);
  EXPECT_NEAR(environment_uv(Mapping::latlong, {0, -1, 0}).y, 1, 1e-6f);
  expect(Mapping::latlong, glm::normalize(Vec3(0, 1, -1)), {0.5f, 0.25f});

  expect(Mapping::angular, {0, 0, -1}, {0.5f, 0.5f});
  expect(Mapping::angular, {1, 0, 0}, {0.75f, 0.5f});
  expect(Mapping::angular, {0, 1, 0}, {0.5f, 0.25f});
  EXPECT_EQ(environment_direction(Mapping::angular, {0.01f, 0.01f}), Vec3(0));

  expect(Mapping::octahedral, {0, 0, 1}, {0.5f, 0.5f});
  expect(Mapping::octahedral, {1, 0, 0}, {1, 0.5f});
  expect(Mapping::octahedral, {0, 1, 0}, {0.5f, 1});
  expect(Mapping::octahedral, {0, -1, 0}, {0.5f, 0});
  expect(Mapping::octahedral, glm::normalize(Vec3(1, 1, 0)), {0.75f, 0.75f});
  const Vec2 corner = environment_uv(Mapping::octahedral, {0, 0, -1});
  EXPECT_NEAR(std::fabs(corner.x - 0.5f), 0.5f, 1e-5f);
  EXPECT_NEAR(std::fabs(corner.y - 0.5f), 0.5f, 1e-5f);
}

TEST(EnvironmentMapping, MapsAreInverses) {
  test::Uniform random(6);
  for (const Mapping mapping : kMappings) {
    for (int i = 0; i < 20000; ++i) {
      const float z = 1 - 2 * random.next(), phi = 2 * kPi * random.next(), r = std::sqrt(1 - z * z);
      const Vec3 d{r * std::cos(phi), r * std::sin(phi), z};
      const Vec3 back = environment_direction(mapping, environment_uv(mapping, d));
      EXPECT_LT(glm::length(back - d), 3e-6f) << static_cast<int>(mapping) << ": " << d.x << " " << d.y << " " << d.z;
    }
  }
}

TEST(EnvironmentMapping, OctahedralKeepsAreas) {
  // Means over a grid of the square equal means over the sphere: z, z², |x| y² ...
  double z2 = 0, xy = 0, x4 = 0;
  constexpr int n = 500;
  for (int i = 0; i < n * n; ++i) {
    const Vec3 d =
        environment_direction(Mapping::octahedral, {(static_cast<float>(i % n) + 0.5f) / n, (static_cast<float>(i / n) + 0.5f) / n});
    EXPECT_NEAR(glm::length(d), 1, 1e-5f);
    z2 += d.z * d.z;
    xy += std::fabs(d.x * d.y);
    x4 += d.x * d.x * d.x * d.x;
  }
  EXPECT_NEAR(z2 / (n * n), 1 / 3., 1e-4);
  EXPECT_NEAR(x4 / (n * n), 1 / 5., 1e-4);
  EXPECT_NEAR(xy / (n * n), 2 / (3 * std::numbers::pi), 1e-4);
}

TEST(EnvironmentLight, BrightTexelIsSeenInItsDirectionOnly) {
  for (const Mapping mapping : kMappings) {
    const int w = mapping == Mapping::latlong ? 32 : 16, h = 16;
    const int bx = w - 5, by = 5;
    const EnvironmentLight light = light_of(bright_texel(w, h, bx, by), mapping);
    const Vec3 d = environment_direction(
        mapping, {(static_cast<float>(bx) + 0.5f) / static_cast<float>(w), (static_cast<float>(by) + 0.5f) / static_cast<float>(h)});
    EXPECT_NEAR(light.radiance(d).x, 1, 1e-4f);
    EXPECT_EQ(light.radiance(-d).x, 0);
    // Samples go there, and nowhere darkness reigns.
    test::Uniform random(9);
    for (int i = 0; i < 1000; ++i) {
      const Vec3 s = light.sample(random.next2());
      EXPECT_GT(glm::dot(s, d), 0.7f);
    }
  }
}

TEST(EnvironmentLight, TransformTurnsThePicture) {
  // The environment's -Z (its centre column) is turned to world +X: counter-clockwise about +Y seen from above would give -X.
  Environment e = environment_of(bright_texel(33, 17, 16, 8), Mapping::latlong);
  e.world_from_environment = Mat3(Vec3(0, 0, 1), Vec3(0, 1, 0), Vec3(-1, 0, 0));
  const EnvironmentLight light(e, Context{});
  EXPECT_NEAR(light.radiance({1, 0, 0}).x, 1, 1e-4f);
  EXPECT_EQ(light.radiance({0, 0, -1}).x, 0);
  EXPECT_GT(light.sample({0.5f, 0.5f}).x, 0.9f);
  EXPECT_GT(light.pdf({1, 0, 0}), 1);
}

TEST(EnvironmentLight, SamplesFollowTheirDensity) {
  for (const Mapping mapping : kMappings) {
    const int w = mapping == Mapping::latlong ? 24 : 16, h = 16;
    const auto image = picture(
        w, h, [&](int x, int y) { return Color(0.2f + static_cast<float>((x * 7 + y * 13) % 5)) * (x == 3 && y == 7 ? 30.f : 1.f); });
    Environment e = environment_of(image, mapping);
    e.world_from_environment = Mat3(Vec3(0, 0, 1), Vec3(0, 1, 0), Vec3(-1, 0, 0));
    const EnvironmentLight light(e, Context{});
    test::Uniform random(21);
    const auto draw = [&]() -> std::optional<Vec3> {
      const Vec3 d = light.sample(random.next2());
      if (d == Vec3(0)) return std::nullopt;
      return d;
    };
    const auto density = [&](const Vec3& d) { return static_cast<double>(light.pdf(d)); };
    const auto result = test::chi_square_directions(draw, density, {Vec3(0, 1, 0), 1, 16, 16}, 100000);
    EXPECT_GT(result.p_value, 1e-4) << static_cast<int>(mapping) << "\n" << result.table;
  }
}

TEST(EnvironmentLight, DensityIntegratesToOneAndEstimatesGiveTheTotal) {
  for (const Mapping mapping : kMappings) {
    const int w = mapping == Mapping::latlong ? 24 : 16, h = 16;
    const auto image = picture(w, h, [&](int x, int y) { return Color(0.2f + static_cast<float>((x * 7 + y * 13) % 5)); });
    const EnvironmentLight light = light_of(image, mapping);
    double integral = 0, truth = 0, estimate = 0;
    constexpr int n = 512;
    for (int i = 0; i < n * n; ++i) {
      const Vec2 u{(static_cast<float>(i % n) + 0.5f) / n, (static_cast<float>(i / n) + 0.5f) / n};
      const Vec3 d = environment_direction(Mapping::octahedral, u);
      integral += light.pdf(d) * 4 * std::numbers::pi / (static_cast<double>(n) * n);
      truth += light.radiance(d).x * 4 * std::numbers::pi / (static_cast<double>(n) * n);
      const Vec3 s = light.sample(u);
      const float pdf = light.pdf(s);
      if (s != Vec3(0) && pdf > 0) estimate += light.radiance(s).x / pdf / (static_cast<double>(n) * n);
    }
    // The rim of an angular map loses samples that fall outside the picture.
    EXPECT_NEAR(integral, 1, mapping == Mapping::angular ? 0.01 : 1e-3) << static_cast<int>(mapping);
    EXPECT_NEAR(estimate / truth, 1, 2e-3) << static_cast<int>(mapping);
    EXPECT_NEAR(light.total_luminance() / truth, 1, mapping == Mapping::angular ? 0.03 : 2e-3) << static_cast<int>(mapping);
  }
}

TEST(EnvironmentLight, NoRadianceWithoutDensity) {
  test::Uniform random(33);
  for (const Mapping mapping : kMappings) {
    const int w = mapping == Mapping::latlong ? 32 : 16, h = 16;
    // Also in corners and at edges, where the mappings continue elsewhere.
    for (const auto& [bx, by] : {std::pair{0, 0}, {w - 1, 7}, {5, 0}, {9, h - 1}, {w / 2, h / 2}}) {
      const EnvironmentLight light = light_of(bright_texel(w, h, bx, by), mapping);
      for (int i = 0; i < 20000; ++i) {
        const Vec3 d = environment_direction(Mapping::octahedral, random.next2());
        if (light.radiance(d).x > 1e-6f) {
          ASSERT_GT(light.pdf(d), 0) << static_cast<int>(mapping) << " texel " << bx << "," << by;
        }
      }
    }
  }
}

TEST(EnvironmentLight, BilinearReadsAreContinuousAcrossEdges) {
  test::Uniform random(34);
  for (const Mapping mapping : {Mapping::latlong, Mapping::octahedral}) {
    const int w = mapping == Mapping::latlong ? 32 : 16, h = 16;
    test::Uniform values(35);
    const EnvironmentLight light = light_of(picture(w, h, [&](int, int) { return Color(values.next()); }), mapping);
    for (int i = 0; i < 20000; ++i) {
      // Pairs of close directions, many of them across the seam or an edge of the square.
      Vec3 d = environment_direction(Mapping::octahedral, random.next2());
      if (i % 2) (mapping == Mapping::latlong ? d.x : d.z) *= 1e-4f;
      d = glm::normalize(d);
      // All columns of a latlong picture meet at its poles.
      if (mapping == Mapping::latlong && std::fabs(d.y) > 0.9f) continue;
      const Vec3 close = glm::normalize(d + 1e-4f * Vec3(random.next() - 0.5f, random.next() - 0.5f, random.next() - 0.5f));
      EXPECT_NEAR(light.radiance(d).x, light.radiance(close).x, 0.01f)
          << static_cast<int>(mapping) << ": " << d.x << " " << d.y << " " << d.z;
    }
  }
}

TEST(EnvironmentLight, BigPicturesShareCellsWithoutLosingTheirSampler) {
  // More pixels than cells, sizes that blocks do not divide.
  const int w = 2501, h = 1301;
  const EnvironmentLight light =
      light_of(picture(w, h, [](int x, int y) { return Color((x / 500 + y / 300) % 2 ? 0.f : 1.f); }), Mapping::latlong);
  EXPECT_LT(light.memory_bytes(), EnvironmentLight::kMaxCells * 13ull);
  double integral = 0, estimate = 0, truth = 0;
  constexpr int n = 512;
  for (int i = 0; i < n * n; ++i) {
    const Vec2 u{(static_cast<float>(i % n) + 0.5f) / n, (static_cast<float>(i / n) + 0.5f) / n};
    const Vec3 d = environment_direction(Mapping::octahedral, u);
    integral += light.pdf(d) * 4 * std::numbers::pi / (static_cast<double>(n) * n);
    truth += light.radiance(d).x * 4 * std::numbers::pi / (static_cast<double>(n) * n);
    const Vec3 s = light.sample(u);
    estimate += light.radiance(s).x / light.pdf(s) / (static_cast<double>(n) * n);
  }
  EXPECT_NEAR(integral, 1, 5e-3);
  EXPECT_NEAR(estimate / truth, 1, 5e-3);
}

TEST(EnvironmentLight, BadPixelsAndTransformsAreHandled) {
  const auto image = picture(4, 2, [](int x, int) { return Color(x == 0 ? NAN : x == 1 ? -5.f : x == 2 ? INFINITY : 1.f); });
  int warnings = 0;
  Context context;
  context.log = [&](LogLevel level, std::string_view) { warnings += level == LogLevel::warning; };
  const EnvironmentLight light(environment_of(image, Mapping::latlong), context);
  EXPECT_EQ(warnings, 1);
  test::Uniform random(2);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 d = light.sample(random.next2());
    EXPECT_TRUE(std::isfinite(light.radiance(d).x) && light.pdf(d) > 0);
  }
  Environment skewed = environment_of(bright_texel(4, 2, 1, 1), Mapping::latlong);
  skewed.world_from_environment = Mat3(0);
  EXPECT_THROW(EnvironmentLight(skewed, Context{}), Error);
  // A black picture has no samples.
  const EnvironmentLight black = light_of(picture(4, 2, [](int, int) { return Color(0); }), Mapping::latlong);
  EXPECT_EQ(black.sample({0.5f, 0.5f}), Vec3(0));
  EXPECT_EQ(black.pdf({0, 1, 0}), 0);
}

}  // namespace
}  // namespace sightline
