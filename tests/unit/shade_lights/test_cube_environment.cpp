// Environments as cube maps: where texels are, how they are sampled, and that making one keeps the light.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/core/error.h"
#include "base/math/frame.h"
#include "base/math/vec3_batch.h"
#include "shade/analytic/polygon.h"
#include "shade/cube_map.h"
#include "shade/lights/cube_resample.h"
#include "shade/lights/environment_light.h"
#include "support/chi_square.h"

namespace sightline {
namespace {

std::shared_ptr<const Image> picture(int width, int height, const std::function<float(int, int)>& value) {
  Image image{width, height, 1, Image::Floats{}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) std::get<Image::Floats>(image.data).push_back(value(x, y));
  }
  return std::make_shared<const Image>(std::move(image));
}
std::shared_ptr<const Image> cube_picture(int size, const std::function<float(int, int)>& value) {
  return picture(size, kCubeFaces * size, value);
}
Environment mapped_as(std::shared_ptr<const Image> image, EnvironmentMapping mapping) {
  Environment e;
  e.image = std::move(image);
  e.mapping = mapping;
  return e;
}
Environment cube_of(std::shared_ptr<const Image> image) { return mapped_as(std::move(image), EnvironmentMapping::cube); }

Vec3 any_direction(test::Uniform& random) {
  const float z = 1 - 2 * random.next(), phi = 2 * kPi * random.next(), r = std::sqrt(1 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}

/// Bright and dark texels side by side, also across edges of the cube.
float uneven(int x, int y) { return (x + y) % 3 == 0 ? 0.f : x == 1 && y == 9 ? 60.f : 0.5f + static_cast<float>((x * 7 + y * 13) % 5); }

TEST(CubeEnvironment, DirectionsAndPlacesInThePictureAreInverses) {
  test::Uniform random(3);
  for (int i = 0; i < 20000; ++i) {
    const Vec3 d = any_direction(random);
    const Vec3 back = environment_direction(EnvironmentMapping::cube, environment_uv(EnvironmentMapping::cube, d));
    EXPECT_LT(glm::length(back - d), 5e-6f) << d.x << " " << d.y << " " << d.z;
  }
}

// Directions at once against one by one: of cubes the very same, of other maps but for the last digits of angles, which a smooth picture
// of this size turns into less than a thousandth of what is between its neighbouring pixels.
TEST(EnvironmentBatch, AgreesWithSingleLookUps) {
  test::Uniform random(5);
  const auto color = [](int x, int y) { return uneven(x % 11, y % 13); };
  const auto smooth = [](int x, int y) { return 2 + std::sin(0.05f * static_cast<float>(x)) * std::cos(0.07f * static_cast<float>(y)); };
  const Environment environments[] = {cube_of(cube_picture(7, color)), mapped_as(picture(256, 128, smooth), EnvironmentMapping::latlong),
                                      mapped_as(picture(190, 190, smooth), EnvironmentMapping::angular),
                                      mapped_as(picture(64, 64, smooth), EnvironmentMapping::octahedral), Environment{}};
  for (Environment e : environments) {
    e.scale = Color(0.5f, 1, 2);
    const Vec3 axis = any_direction(random);
    e.world_from_environment = Mat3(frame_from_normal(axis).tangent, frame_from_normal(axis).bitangent, axis);
    const EnvironmentLight light(e, Context{});
    constexpr std::size_t count = 1003;
    Vec3Batch direction, radiance;
    direction.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      // Poles, seams and edges of faces among them.
      Vec3 d = any_direction(random);
      if (i % 5 == 0) d[static_cast<int>(i / 5 % 3)] = 0, d = glm::normalize(d);
      if (i < 6) d = Vec3(0), d[static_cast<int>(i / 2)] = i % 2 ? 1.f : -1.f;
      store(direction, i, e.world_from_environment * d);
    }
    light.radiance(direction, count, radiance);
    const bool angles = e.mapping == EnvironmentMapping::latlong || e.mapping == EnvironmentMapping::angular, exact = !angles || !e.image;
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 d = load(direction, i);
      const Color single = light.radiance(d), batch = load(radiance, i);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(batch[c], single[c], exact ? 0 : 1e-5f) << d.x << " " << d.y << " " << d.z;
    }
  }
}

TEST(CubeEnvironment, EachTexelIsSeenInItsSquareAndConstant) {
  const int size = 5;
  // Each texel has a value of its own.
  const EnvironmentLight light(cube_of(cube_picture(size, [](int x, int y) { return static_cast<float>(1 + y * 5 + x); })), Context{});
  test::Uniform random(4);
  for (int face = 0; face < kCubeFaces; ++face) {
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const auto value = static_cast<float>(1 + (face * size + y) * size + x);
        for (int i = 0; i < 20; ++i) {
          const float u = (2 * (static_cast<float>(x) + 0.001f + 0.998f * random.next())) / size - 1;
          const float v = (2 * (static_cast<float>(y) + 0.001f + 0.998f * random.next())) / size - 1;
          ASSERT_EQ(light.radiance(glm::normalize(cube_direction(face, u, v))).x, value) << face << ": " << u << " " << v;
        }
      }
    }
  }
  // The convention: face +X has -Z to the right and +Y on top.
  EXPECT_EQ(light.radiance(glm::normalize(Vec3(1, 0.9f, -0.9f))).x, 5);
  EXPECT_EQ(light.radiance(glm::normalize(Vec3(1, 0.9f, 0.9f))).x, 1);
}

TEST(CubeEnvironment, SamplesFollowTheirDensity) {
  for (const int size : {1, 4, 7}) {
    // Nothing is quite dark: a lit sliver of a cell of the test's own grid would be missed by its quadrature.
    Environment e = cube_of(cube_picture(size, [](int x, int y) { return 0.2f + uneven(x, y); }));
    e.world_from_environment = Mat3(Vec3(0, 0, 1), Vec3(0, 1, 0), Vec3(-1, 0, 0));
    const EnvironmentLight light(e, Context{});
    test::Uniform random(21);
    const auto draw = [&]() -> std::optional<Vec3> { return light.sample(random.next2()); };
    const auto density = [&](const Vec3& d) { return static_cast<double>(light.pdf(d)); };
    const auto result = test::chi_square_directions(draw, density, {Vec3(0, 1, 0), 1, 16, 16}, 100000);
    EXPECT_GT(result.p_value, 1e-4) << size << "\n" << result.table;
  }
}

TEST(CubeEnvironment, SamplesGoToTexelsByTheirLightAndNeverIntoTheDark) {
  const int size = 6;
  const EnvironmentLight light(cube_of(cube_picture(size, uneven)), Context{});
  std::vector<double> expected(kCubeFaces * size * size), observed(expected.size());
  constexpr int kCount = 200000;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const int x = static_cast<int>(i) % size, y = static_cast<int>(i) / size;
    expected[i] = kCount * static_cast<double>(uneven(x, y) * cube_texel_solid_angle(x, y % size, size)) / light.total_luminance();
  }
  test::Uniform random(5);
  int dark = 0;
  for (int i = 0; i < kCount; ++i) {
    const Vec3 d = light.sample(random.next2());
    const CubePlace place = cube_place(d);
    const auto index = [&](float u) { return std::min(static_cast<int>((u + 1) * 0.5f * size), size - 1); };
    observed[static_cast<std::size_t>((place.face * size + index(place.v)) * size + index(place.u))] += 1;
    dark += light.radiance(d).x == 0;
  }
  EXPECT_EQ(dark, 0);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (expected[i] == 0) observed[i] = 0;
  }
  EXPECT_GT(test::chi_square(observed, expected).p_value, 1e-4);
}

TEST(CubeEnvironment, EstimatesGiveTheTotal) {
  const EnvironmentLight light(cube_of(cube_picture(8, uneven)), Context{});
  double truth = 0, estimate = 0;
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 8; ++x) truth += static_cast<double>(uneven(x, y) * cube_texel_solid_angle(x, y % 8, 8));
  }
  constexpr int n = 512;
  for (int i = 0; i < n * n; ++i) {
    const Vec3 d = light.sample({(static_cast<float>(i % n) + 0.5f) / n, (static_cast<float>(i / n) + 0.5f) / n});
    const EnvironmentLight::Evaluation e = light.evaluate(d);
    EXPECT_EQ(e.pdf, light.pdf(d));
    estimate += static_cast<double>(e.radiance.x / e.pdf) / (n * n);
  }
  EXPECT_NEAR(light.total_luminance() / truth, 1, 1e-5);
  EXPECT_NEAR(estimate / truth, 1, 1e-3);
}

TEST(CubeEnvironment, LambertUnderOneTexelMeetsTheFormulaForPolygons) {
  const int size = 4, bx = 2, by = 1;
  for (int face = 0; face < kCubeFaces; ++face) {
    const EnvironmentLight light(cube_of(cube_picture(size, [&](int x, int y) { return x == bx && y == face * size + by ? 3.f : 0.f; })),
                                 Context{});
    const Vec3 corners[4] = {cube_direction(face, 0, -0.5f), cube_direction(face, 0.5f, -0.5f), cube_direction(face, 0.5f, 0),
                             cube_direction(face, 0, 0)};
    test::Uniform random(8);
    for (int k = 0; k < 8; ++k) {
      const Vec3 normal = any_direction(random);
      const double truth = 3 * std::numbers::pi * polygon_irradiance(corners, Vec3(0), normal, EmitterSides::two);
      double estimate = 0;
      constexpr int n = 128;
      for (int i = 0; i < n * n; ++i) {
        const Vec3 d = light.sample({(static_cast<float>(i % n) + 0.5f) / n, (static_cast<float>(i / n) + 0.5f) / n});
        estimate += static_cast<double>(light.radiance(d).x * std::max(0.f, glm::dot(normal, d)) / light.pdf(d)) / (n * n);
      }
      EXPECT_NEAR(estimate, truth, 1e-3) << face;
    }
  }
}

TEST(CubeResample, KeepsTheLightOfEveryMapping) {
  struct Case {
    EnvironmentMapping mapping;
    int width, height;
  };
  for (const Case& c : {Case{EnvironmentMapping::latlong, 256, 128}, Case{EnvironmentMapping::octahedral, 128, 128},
                        Case{EnvironmentMapping::cube, 48, 288}}) {
    // Nearly all light from one pixel.
    const auto image = picture(c.width, c.height, [&](int x, int y) { return x == 77 % c.width && y == 40 ? 1e5f : 0.1f; });
    Environment e = mapped_as(image, c.mapping);
    e.scale = Color(2);
    const double truth = EnvironmentLight(e, Context{}).total_luminance();
    for (const int size : {1, 5, 32}) {
      const EnvironmentLight cube(environment_as_cube(e, size, Context{}), Context{});
      EXPECT_NEAR(cube.total_luminance() / truth, 1, c.mapping == EnvironmentMapping::cube ? 1e-5 : 1e-2)
          << static_cast<int>(c.mapping) << " to " << size;
    }
  }
}

TEST(CubeResample, TexelsAreMeansByDirection) {
  // Radiance 2 + x + 0.3 y², of which the mean over a texel is known by fine quadrature.
  const auto radiance = [](const Vec3& d) { return Color(2 + d.x + 0.3f * d.y * d.y); };
  const std::vector<Color> texels = resample_to_cube(radiance, 3, 16, Context{});
  ASSERT_EQ(texels.size(), 54u);
  for (int t = 0; t < 54; ++t) {
    const int x = t % 3, y = t / 3 % 3, face = t / 9;
    double sum = 0, weights = 0;
    for (int i = 0; i < 100 * 100; ++i) {
      const Vec3 d = cube_direction(face, cube_coordinate(100 * x + i % 100, 300), cube_coordinate(100 * y + i / 100, 300));
      const double weight = std::pow(static_cast<double>(length_squared(d)), -1.5);
      sum += weight * static_cast<double>(radiance(glm::normalize(d)).x);
      weights += weight;
    }
    EXPECT_NEAR(static_cast<double>(texels[static_cast<std::size_t>(t)].x), sum / weights, 2e-4);
  }
}

TEST(CubeResample, ACubeOfTheSizeAskedForStaysAndConstantsStayConstant) {
  const Environment cube = cube_of(cube_picture(4, uneven));
  EXPECT_EQ(environment_as_cube(cube, 4, Context{}).image, cube.image);
  const EnvironmentLight coarse(cube, Context{}), fine(environment_as_cube(cube, 12, Context{}), Context{});
  Environment white;
  white.scale = Color(0.5f, 1, 2);
  const EnvironmentLight furnace(environment_as_cube(white, 8, Context{}), Context{});
  EXPECT_NEAR(furnace.total_luminance(), 4 * std::numbers::pi * static_cast<double>(luminance(white.scale)), 1e-4);
  test::Uniform random(9);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 d = any_direction(random);
    EXPECT_NEAR(fine.radiance(d).x, coarse.radiance(d).x, 1e-5f);
    EXPECT_EQ(furnace.radiance(d), white.scale);
  }
}

TEST(CubeResample, ImpossibleSizesAndPicturesAreErrors) {
  EXPECT_THROW(environment_as_cube(Environment{}, 0, Context{}), Error);
  EXPECT_THROW(environment_as_cube(Environment{}, kMaxCubeSize + 1, Context{}), Error);
  EXPECT_THROW(EnvironmentLight(cube_of(picture(8, 32, uneven)), Context{}), Error);
}

}  // namespace
}  // namespace sightline
