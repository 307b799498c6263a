// Closed shells that glow: every ray meets the same radiance, and with N bounces a cut geometric series.
#include <gtest/gtest.h>

#include <cmath>

#include "support/picture_statistics.h"

namespace sightline::test {
namespace {

/// Emission seen after 0, 1, ... N + 1 reflections: N indirect bounces and the light that reaches the last of them.
double series(double emission, double albedo, int max_bounces) { return emission * (1 - std::pow(albedo, max_bounces + 2)) / (1 - albedo); }

std::vector<Vec3d> uniform(const Shot& shot, double value) {
  return std::vector<Vec3d>(static_cast<std::size_t>(shot.size_px.x * shot.size_px.y), Vec3d(value));
}

TEST(Enclosure, BsdfSamplingIsExact) {
  for (const char* spec : {"lit-sphere-inside,albedo=0.5", "lit-sphere-inside,albedo=0.5,mesh=true", "furnace,shape=box,albedo=0.5"}) {
    const bool box = std::string_view(spec).starts_with("furnace");
    const Shot shot = shot_of(builtin_scene(spec), {16, 16});
    for (const int bounces : {0, 1, 5, 30}) {
      const Picture picture = expose(shot, {.settings = {"roulette_start=100000"}, .spp = 2, .max_bounces = bounces, .bsdf_only = true});
      const double truth = series(box ? 0.5 : 1, 0.5, bounces);
      for (std::uint32_t pixel = 0; pixel < 256; ++pixel) EXPECT_NEAR(picture.frame.color(pixel).y, truth, 1e-4 * truth) << spec << bounces;
    }
  }
}

TEST(Enclosure, LightsAndBsdfsTogetherMeetTheSeries) {
  for (const char* spec : {"lit-sphere-inside,albedo=0.5", "lit-sphere-inside,albedo=0.5,mesh=true", "furnace,shape=box,albedo=0.5"}) {
    const bool box = std::string_view(spec).starts_with("furnace");
    const Shot shot = shot_of(builtin_scene(spec), {4, 4});
    for (const int bounces : {0, 1, 20}) {
      const Replicates seen = replicate(shot, {.spp = 128, .max_bounces = bounces}, 64);
      const PictureTest test = compare(seen, uniform(shot, series(box ? 0.5 : 1, 0.5, bounces)));
      EXPECT_GT(test.pixel_p, 1e-3) << spec << " " << bounces << " bounces: " << test.worst;
      EXPECT_GT(test.mean_p, 1e-3) << spec << " " << bounces << " bounces: " << test.worst;
      EXPECT_LE(seen.picture_error.y, 1e-3) << spec;
    }
  }
}

}  // namespace
}  // namespace sightline::test
