#include "session/options_text.h"

#include <gtest/gtest.h>

#include "base/core/error.h"

namespace sightline {
namespace {

TEST(OptionsText, AreaLightHasTheDocumentedAxes) {
  const RectangleLight ceiling = std::get<RectangleLight>(parse_light_area("0,11,0 0,-1,0 2x4 60,50,40").shape);
  EXPECT_EQ(ceiling.center, Vec3(0, 11, 0));
  EXPECT_EQ(ceiling.radiance, Color(60, 50, 40));
  EXPECT_NEAR(glm::length(ceiling.half_u - Vec3(1, 0, 0)), 0, 1e-6f);  // width along +X where the normal is vertical
  EXPECT_NEAR(glm::length(ceiling.half_v), 2, 1e-6f);
  EXPECT_NEAR(glm::length(glm::normalize(glm::cross(ceiling.half_u, ceiling.half_v)) - Vec3(0, -1, 0)), 0, 1e-6f);

  const RectangleLight wall = std::get<RectangleLight>(parse_light_area("1,2,3  0,0,2  6x2 1,1,1").shape);
  EXPECT_NEAR(glm::length(wall.half_u - Vec3(3, 0, 0)), 0, 1e-6f);  // cross(+Y, +Z) = +X
  EXPECT_NEAR(glm::length(wall.half_v - Vec3(0, 1, 0)), 0, 1e-6f);
  EXPECT_NEAR(glm::length(glm::normalize(glm::cross(wall.half_u, wall.half_v)) - Vec3(0, 0, 1)), 0, 1e-6f);
}

TEST(OptionsText, DirectionalLightIsNormalised) {
  const DirectionalLight light = std::get<DirectionalLight>(parse_light_directional("0.3,-1,0.2 3,3,3").shape);
  EXPECT_NEAR(glm::length(light.direction), 1, 1e-6f);
  EXPECT_EQ(light.irradiance, Color(3));
}

TEST(OptionsText, RangesAndSizes) {
  EXPECT_EQ(parse_size("--size", "640x480"), IVec2(640, 480));
  EXPECT_EQ(parse_sample_range("--sample-range", "3:9"), (SampleRange{3, 9}));
  const FrameRange frames = parse_frame_range("--frames", "2-10x4");
  EXPECT_EQ(frames.first, 2);
  EXPECT_EQ(frames.last, 10);
  EXPECT_EQ(frames.step, 4);
}

TEST(OptionsText, MistakesAreUsageErrors) {
  for (const char* text : {"", "0x1", "640", "640x", "x480", "-1x4", "1e9x1", "640x480x2"})
    EXPECT_THROW(parse_size("--size", text), Error) << text;
  for (const char* text : {"", "1,2", "1,2,3,4", "1,2,a", "nan,1,2", "inf,0,0"}) EXPECT_THROW(parse_vec3("--eye", text), Error) << text;
  for (const char* text : {"5", "5:5", "6:2", "-1:4", "a:b"}) EXPECT_THROW(parse_sample_range("--sample-range", text), Error) << text;
  for (const char* text : {"", "0,0,0 0,0,0 1x1 1,1,1", "0,0,0 0,1,0 0x1 1,1,1", "0,0,0 0,1,0 1x1"})
    EXPECT_THROW(parse_light_area(text), Error) << text;
}

}  // namespace
}  // namespace sightline
