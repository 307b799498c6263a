#include "unit/scene_pbrt/pbrt_text.h"

namespace sightline {
namespace {

template <class L>
L light_of(const Scene& scene) {
  EXPECT_EQ(scene.lights.size(), 1u);
  return std::get<L>(scene.lights.at(0).shape);
}

TEST(PbrtLights, PointLightsAreMovedAndScaled) {
  const auto light = light_of<PointLight>(
      parse_world("Translate 1 1 1 Scale 2 2 2 LightSource \"point\" \"point3 from\" [1 2 3] \"rgb I\" [1 2 3] \"float scale\" 10\n"));
  expect_near(light.position, {3, 5, 7});
  expect_near(light.intensity, {10, 20, 30});
}

TEST(PbrtLights, PowerSetsTheEmittedWatts) {
  expect_near(light_of<PointLight>(parse_world("LightSource \"point\" \"float power\" 100\n")).intensity, Vec3(100 / (4 * kPi)), 1e-4f);
  const auto spot =
      light_of<SpotLight>(parse_world("LightSource \"spot\" \"float power\" 10 \"float coneangle\" 60 \"float conedeltaangle\" 60\n"));
  // The mean of the smooth step over the cosine is one half.
  EXPECT_NEAR(spot.intensity.x * 2 * kPi * (1 - 0.5f) / 2, 10, 1e-4f);
}

TEST(PbrtLights, SpotsAndDistantLightsPointWherePbrtsDo) {
  const auto spot =
      light_of<SpotLight>(parse_world("Rotate 90 0 0 1 LightSource \"spot\" \"point3 from\" [1 0 0] \"point3 to\" [1 5 0] \"float "
                                      "coneangle\" 40 \"float conedeltaangle\" 10\n"));
  expect_near(spot.position, {0, 1, 0});
  expect_near(spot.direction, {-1, 0, 0});
  EXPECT_FLOAT_EQ(spot.outer_angle_rad, glm::radians(40.f));
  EXPECT_FLOAT_EQ(spot.inner_angle_rad, glm::radians(30.f));
  EXPECT_EQ(spot.falloff, SpotLight::Falloff::pbrt);
  const auto sun = light_of<DirectionalLight>(parse_world(
      "Scale 1 1 -1 LightSource \"distant\" \"point3 from\" [0 0 2] \"point3 to\" [0 0 0] \"rgb L\" [10 5 1] \"float illuminance\" 3\n"));
  expect_near(sun.direction, {0, 0, 1});
  expect_near(sun.irradiance, {30, 15, 3});
}

TEST(PbrtLights, SpectralLightsHaveLuminanceOne) {
  const auto warm = light_of<PointLight>(parse_world("LightSource \"point\" \"blackbody I\" 2700 \"float scale\" 4\n")).intensity;
  EXPECT_NEAR(luminance(warm), 4, 1e-4f);
  EXPECT_GT(warm.x, warm.y);
  EXPECT_GT(warm.y, warm.z);
  const auto cold = light_of<PointLight>(parse_world("LightSource \"point\" \"blackbody I\" 6500\n")).intensity;
  EXPECT_NEAR(cold.x, 1, 0.05f);
  EXPECT_NEAR(cold.z, 1, 0.06f);
  // The magnitude of a sampled light spectrum is lost in pbrt-v4, and so it is here.
  EXPECT_NEAR(luminance(light_of<PointLight>(parse_world("LightSource \"point\" \"spectrum I\" [400 7 700 7]\n")).intensity), 1, 1e-4f);
  const auto white = light_of<PointLight>(parse_world("LightSource \"point\" \"spectrum I\" \"stdillum-D65\"\n")).intensity;
  expect_near(white, {1, 1, 1}, 5e-3f);
}

TEST(PbrtLights, AreaLightsEmitFromTheirMaterial) {
  const Scene scene =
      parse_world("AreaLightSource \"diffuse\" \"rgb L\" [17 12 4] \"float scale\" 2 \"bool twosided\" true\n" + std::string(kTriangle));
  expect_near(scene.materials[0].emission.value, {34, 24, 8});
  EXPECT_TRUE(scene.materials[0].emission_two_sided);
  // Of a mesh pbrt gives each triangle the power: L = power / (pi area) with area 1/2.
  const Scene bright = parse_world("AreaLightSource \"diffuse\" \"float power\" 5\n" + std::string(kTriangle));
  EXPECT_NEAR(bright.materials[0].emission.value.x, 5 / (kPi * 0.5f), 1e-4f);
  const Scene ball = parse_world("AreaLightSource \"diffuse\" \"float power\" 5 Shape \"sphere\" \"float radius\" 2\n");
  EXPECT_NEAR(ball.materials[ball.spheres[0].material.index].emission.value.x, 5 / (kPi * 16 * kPi), 1e-5f);
  const Scene disk = parse_world("AreaLightSource \"diffuse\" \"float power\" 5 Shape \"disk\" \"float radius\" 2\n");
  EXPECT_NEAR(disk.materials[0].emission.value.x, 5 / (kPi * 4 * kPi), 1e-5f);
}

TEST(PbrtLights, AnInterfaceDoesNotEmit) {
  const Scene scene = parse_world("Material \"interface\" AreaLightSource \"diffuse\"\n" + std::string(kTriangle));
  EXPECT_EQ(scene.materials[0].emission.value, Color(0));
  EXPECT_TRUE(warns_of(scene, "test.pbrt:2:22: an area light on an interface"));
}

TEST(PbrtLights, ConstantInfiniteLightsAddUp) {
  const Scene scene =
      parse_world("LightSource \"infinite\" \"rgb L\" [.4 .5 .6] \"float scale\" 2\nLightSource \"infinite\" \"rgb L\" [.1 .1 .1]\n");
  ASSERT_TRUE(scene.environment.has_value());
  expect_near(scene.environment->scale, {0.9f, 1.1f, 1.3f});
  EXPECT_FALSE(scene.environment->image);
  const Scene lit = parse_world("LightSource \"infinite\" \"float illuminance\" 6\n");
  EXPECT_NEAR(lit.environment->scale.x, 6 / kPi, 1e-5f);
}

TEST(PbrtLights, OtherFilesAreOutOfReachFromMemory) {
  const Scene scene =
      parse_world("LightSource \"infinite\" \"string filename\" \"/etc/sky.exr\"\nShape \"plymesh\" \"string filename\" \"/etc/a.ply\"\n");
  EXPECT_FALSE(scene.environment->image);
  EXPECT_TRUE(warns_of(scene, "test.pbrt:2:1: image '/etc/sky.exr' is not read"));
  EXPECT_TRUE(warns_of(scene, "test.pbrt:3:1: mesh file '/etc/a.ply' is not there"));
}

TEST(PbrtLights, UnknownOnesAreReported) {
  EXPECT_TRUE(warns_of(parse_world("LightSource \"goniometric\" \"string filename\" \"x\"\n"), "test.pbrt:2:1: light type 'goniometric'"));
  EXPECT_TRUE(warns_of(parse_world("LightSource \"point\" \"rgb L\" [1 1 1]\n"), "\"rgb L\" has no effect on light type 'point'"));
  EXPECT_FALSE(error_of("WorldBegin LightSource \"point\" \"float scale\" -1").empty());
}

}  // namespace
}  // namespace sightline
