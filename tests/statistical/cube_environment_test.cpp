// The reference under environments that are cube maps: closed formulas in every pixel.
#include <gtest/gtest.h>

#include <cmath>

#include "film/view.h"
#include "shade/analytic/polygon.h"
#include "shade/cube_map.h"
#include "shade/lights/cube_resample.h"
#include "support/studio.h"

namespace sightline::test {
namespace {

Environment one_texel(int size, int texel, float radiance) {
  Image image{size, kCubeFaces * size, 1, Image::Floats(static_cast<std::size_t>(kCubeFaces * size * size), 0.f)};
  std::get<Image::Floats>(image.data)[static_cast<std::size_t>(texel)] = radiance;
  Environment environment;
  environment.image = std::make_shared<const Image>(std::move(image));
  environment.mapping = EnvironmentMapping::cube;
  return environment;
}

TEST(CubeEnvironment, LambertBallUnderOneTexelIsExactInEveryPixel) {
  const int size = 4, x = 1, y = 1;
  for (const int face : {0, 2, 4}) {
    Scene scene = builtin_scene("furnace,albedo=0.8");
    scene.environment = one_texel(size, (face * size + y) * size + x, 5);
    const Shot shot = shot_of(std::move(scene), {32, 32});
    const Picture picture = expose(shot, {.spp = 256, .light_samples = 1, .max_bounces = 0});
    const auto edge = [&](int i) { return 2 * static_cast<float>(i) / static_cast<float>(size) - 1; };
    const Vec3 corners[4] = {cube_direction(face, edge(x), edge(y)), cube_direction(face, edge(x + 1), edge(y)),
                             cube_direction(face, edge(x + 1), edge(y + 1)), cube_direction(face, edge(x), edge(y + 1))};
    int lit = 0;
    for (std::uint32_t pixel = 0; pixel < 32 * 32; ++pixel) {
      Vec3 origin, direction;
      centre_ray(shot, pixel, origin, direction);
      const float b = glm::dot(origin, direction), c = length_squared(origin) - 1, discriminant = b * b - c;
      // Not at the rim, where the centre of the pixel just touches the ball.
      if (discriminant < 0.01f) continue;
      const Vec3 normal = origin + (-b - std::sqrt(discriminant)) * direction;
      const double truth = 0.8 * 5 * polygon_irradiance(corners, Vec3(0), normal, EmitterSides::two);
      EXPECT_NEAR(picture.frame.color(pixel).x, truth, 0.02 * truth + 2e-3) << "face " << face << " pixel " << pixel;
      lit += truth > 0.01;
    }
    EXPECT_GT(lit, 50) << "face " << face;
  }
}

TEST(CubeEnvironment, FurnaceShowsTheAlbedoOnly) {
  Scene scene = builtin_scene("furnace,albedo=0.6");
  scene.environment = environment_as_cube(Environment{}, 8, Context{});
  const Shot shot = shot_of(std::move(scene), {16, 16});
  const Picture picture = expose(shot, {.spp = 256});
  EXPECT_NEAR(picture.frame.color(8 * 16 + 8).x, 0.6f, 0.02f);
  EXPECT_EQ(picture.frame.color(0).x, 1);
}

}  // namespace
}  // namespace sightline::test
