#include "unit/scene_pbrt/pbrt_text.h"

namespace sightline {
namespace {

TEST(PbrtCamera, LooksAlongPlusZOfItsSpaceWithXToTheRight) {
  const Scene scene = parse_text("Camera \"perspective\" \"float fov\" 40 WorldBegin");
  ASSERT_EQ(scene.cameras.size(), 1u);
  const Camera& camera = scene.cameras[0];
  expect_near(transform_vector(camera.world_from_camera, {0, 0, -1}), {0, 0, 1});
  expect_near(transform_vector(camera.world_from_camera, {1, 0, 0}), {1, 0, 0});
  expect_near(transform_vector(camera.world_from_camera, {0, 1, 0}), {0, 1, 0});
  EXPECT_LT(glm::determinant(glm::mat3(camera.world_from_camera)), 0);  // a left-handed world
  EXPECT_FLOAT_EQ(camera.fov_rad, glm::radians(40.f));
  EXPECT_EQ(camera.fov_axis, Camera::FovAxis::shorter);
}

TEST(PbrtCamera, AMirroringTransformationMirrorsThePicture) {
  // The usual right-handed scene: Scale -1 1 1 before LookAt.
  const Scene scene = parse_text("Scale -1 1 1 LookAt 1 2 3 1 2 0 0 1 0 Camera \"perspective\" WorldBegin");
  const Mat4& m = scene.cameras[0].world_from_camera;
  expect_near(transform_point(m, {0, 0, 0}), {1, 2, 3});
  expect_near(transform_vector(m, {0, 0, -1}), {0, 0, -1});
  expect_near(transform_vector(m, {1, 0, 0}), {1, 0, 0});
  EXPECT_GT(glm::determinant(glm::mat3(m)), 0);
}

TEST(PbrtCamera, TheCornellBoxCameraStandsInFront) {
  // A matrix as the scenes of Bitterli have them: z mirrored, 6.8 back and 1 up.
  const Scene scene =
      parse_text("Transform [1 0 0 0  0 1 0 0  0 0 -1 0  0 -1 6.8 1] Camera \"perspective\" \"float fov\" [19.5] WorldBegin");
  const Mat4& m = scene.cameras[0].world_from_camera;
  expect_near(transform_point(m, {0, 0, 0}), {0, 1, 6.8f});
  expect_near(transform_vector(m, {0, 0, -1}), {0, 0, -1});
  expect_near(transform_vector(m, {1, 0, 0}), {1, 0, 0});
}

TEST(PbrtCamera, LensWindowAndOrthographicAreKept) {
  const Scene scene =
      parse_text("Camera \"orthographic\" \"float screenwindow\" [-2 3 -1 4] \"float lensradius\" .1 \"float focaldistance\" 7 WorldBegin");
  const Camera& camera = scene.cameras[0];
  EXPECT_EQ(camera.projection, Camera::Projection::orthographic);
  EXPECT_FLOAT_EQ(camera.ortho_height, 2);
  ASSERT_TRUE(camera.screen_window.has_value());
  EXPECT_EQ(*camera.screen_window, Vec4(-2, -1, 3, 4));
  EXPECT_FLOAT_EQ(camera.lens_radius, 0.1f);
  EXPECT_FLOAT_EQ(camera.focal_distance, 7);
}

TEST(PbrtCamera, FilmIntegratorAndSamplerBecomeHints) {
  const Scene scene = parse_text(
      "Film \"rgb\" \"integer xresolution\" [320] \"integer yresolution\" 200 \"string filename\" \"o.exr\"\n"
      "Integrator \"path\" \"integer maxdepth\" 9 Sampler \"sobol\" \"integer pixelsamples\" 64 PixelFilter \"gaussian\" \"float xradius\" "
      "2 Accelerator \"bvh\" WorldBegin");
  EXPECT_EQ(scene.hints.size_px, IVec2(320, 200));
  EXPECT_EQ(scene.hints.max_bounces, 8);
  EXPECT_EQ(scene.hints.spp, 64);
  EXPECT_EQ(scene.hints.output, "o.exr");
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(PbrtCamera, ExposureScalesTheLights) {
  const Scene scene = parse_text(
      "Film \"rgb\" \"float exposuretime\" .5 \"float iso\" 400 WorldBegin LightSource \"point\" \"rgb I\" [1 2 3]\n"
      "AreaLightSource \"diffuse\" \"rgb L\" [1 1 1]\n" +
      std::string(kTriangle));
  expect_near(std::get<PointLight>(scene.lights[0].shape).intensity, {2, 4, 6});
  expect_near(scene.materials[0].emission.value, {2, 2, 2});
}

TEST(PbrtCamera, ImpossibleValuesAreErrors) {
  for (const char* text :
       {"Camera \"perspective\" \"float fov\" 180 WorldBegin", "Camera \"perspective\" \"float fov\" -1 WorldBegin",
        "Camera \"perspective\" \"float screenwindow\" [1 -1 0 1] WorldBegin", "Film \"rgb\" \"integer xresolution\" 0 WorldBegin",
        "Film \"rgb\" \"integer xresolution\" 2000000000 WorldBegin", "Sampler \"sobol\" \"integer pixelsamples\" 0 WorldBegin"}) {
    EXPECT_NE(error_of(text).find("test.pbrt:1:1: "), std::string::npos) << text;
  }
}

TEST(PbrtCamera, WhatHasNoEffectIsReportedWithItsPlaceAndTheNearestName) {
  const Scene scene = parse_text("Camera \"perspective\"\n  \"float fow\" 30 WorldBegin");
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_EQ(scene.warnings[0], "test.pbrt:2:3: \"float fow\" has no effect on the camera (did you mean 'fov'?)");
}

}  // namespace
}  // namespace sightline
