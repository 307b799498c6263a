// Bidirectional path tracing against the reference: two estimates of the same picture that share little but the BSDFs.
#include <gtest/gtest.h>

#include "methods/bidirectional/settings.h"
#include "scene/builtin/parts.h"
#include "support/picture_statistics.h"

namespace sightline::test {
namespace {

constexpr double kFamily = 1e-3;

struct Case {
  std::string name;
  Scene scene;
  int max_bounces = 4;
  int reference_spp = 64, spp = 16;
  std::vector<std::string> settings{};
  PixelFilter::Kind filter = PixelFilter::Kind::gaussian;
  double brightest = 1;  ///< that a path may carry
  IVec2 size_px{12, 9};
};

/// A pixel may see something bright in a corner of its filter, or a rare path, that none of the samples met: then their scatter says
/// nothing. One more such path is never a surprise.
Replicates with_one_more_path(Replicates replicates, double brightest, int samples) {
  for (Vec3d& error : replicates.error) error = glm::sqrt(error * error + Vec3d(brightest * brightest / (1.0 * samples * samples)));
  return replicates;
}

void expect_same(const Case& c) {
  const Shot shot = shot_of(c.scene, c.size_px);
  const Replicates reference = replicate(shot, {.spp = c.reference_spp, .max_bounces = c.max_bounces, .seed = 1, .filter = c.filter}, 24);
  const Replicates bidirectional = replicate(
      shot, {.method = "bidirectional", .settings = c.settings, .spp = c.spp, .max_bounces = c.max_bounces, .seed = 7, .filter = c.filter},
      24);
  const PictureTest test =
      compare(with_one_more_path(reference, c.brightest, 24 * c.reference_spp), with_one_more_path(bidirectional, c.brightest, 24 * c.spp));
  std::string text = c.name + ": means " + std::to_string(reference.picture_mean.y) + " +- " + std::to_string(reference.picture_error.y) +
                     ", " + std::to_string(bidirectional.picture_mean.y) + " +- " + std::to_string(bidirectional.picture_error.y) + "; p " +
                     std::to_string(test.pixel_p) + ", " + std::to_string(test.mean_p) + "; " + test.worst;
  EXPECT_GT(test.pixel_p, kFamily) << text;
  EXPECT_GT(test.mean_p, kFamily) << text;
}

Scene with_sky(Scene scene) {
  scene.lights.clear();
  scene.environment = Environment{};
  scene.environment->scale = Color(0.5f, 0.7f, 1.f);
  if (scene.cameras.empty()) scene.cameras.push_back(framing_camera(scene.framing.value_or(scene_bounds(scene))));
  return scene;
}

/// A floor with a ball on it, lit from above by `light`.
Scene ball_under(const Light& light, const SurfaceModel& model, const SurfaceModel& floor = DiffuseMaterial{.reflectance = Color(0.7f)}) {
  Scene scene;
  builtin::add_mesh(scene, builtin::MeshBuilder().quad({-2, 0, -2}, {0, 0, 4}, {4, 0, 0}).build("floor"),
                    builtin::add_material(scene, "floor", floor));
  builtin::add_mesh(scene, builtin::MeshBuilder().quad({-2, 0, -2}, {4, 0, 0}, {0, 3, 0}).build("wall"),
                    builtin::add_diffuse(scene, "wall", Color(0.6f, 0.7f, 0.5f)));
  builtin::add_sphere(scene, "ball", {0, 0.8f, 0}, 0.8f, builtin::add_material(scene, "ball", model));
  scene.lights.push_back(light);
  builtin::add_camera(scene, {0.5f, 1.6f, 4}, {0, 0.7f, 0}, 45);
  return scene;
}

template <class Shape>
Light light_of(const Shape& shape) {
  return {.name = "light", .shape = shape, .node = {}};
}

TEST(Bidirectional, AgreesWithTheReferenceOnBuiltinScenes) {
  const Case cases[] = {
      {.name = "cornell", .scene = builtin_scene("cornell"), .brightest = 16},
      {.name = "veach-like", .scene = builtin_scene("veach-like"), .brightest = 900},
      {.name = "textured", .scene = builtin_scene("textured")},
      {.name = "furnace", .scene = builtin_scene("furnace")},
      {.name = "furnace,shape=box", .scene = builtin_scene("furnace,shape=box")},
      {.name = "hairball", .scene = builtin_scene("hairball,triangles=1000")},
      {.name = "quad", .scene = builtin_scene("quad")},
      {.name = "two-quads", .scene = builtin_scene("two-quads")},
      {.name = "lit-sphere-inside", .scene = builtin_scene("lit-sphere-inside")},
      {.name = "half-plane", .scene = builtin_scene("half-plane")},
      {.name = "half-plane,light=directional", .scene = builtin_scene("half-plane,light=directional")},
      {.name = "isosurface", .scene = with_sky(builtin_scene("isosurface,triangles=2000")), .max_bounces = 2},
      {.name = "plant", .scene = with_sky(builtin_scene("plant,triangles=5000")), .max_bounces = 2},
      {.name = "open-room", .scene = with_sky(builtin_scene("open-room,content=cornell")), .max_bounces = 2, .brightest = 16},
  };
  for (const Case& c : cases) expect_same(c);
}

TEST(Bidirectional, AgreesWithTheReferenceOnEveryKindOfLight) {
  const SurfaceModel diffuse = DiffuseMaterial{.reflectance = Color(0.8f, 0.4f, 0.2f)};
  const std::pair<const char*, Light> lights[] = {
      {"point", light_of(PointLight{.position = {1, 2.5f, 1}, .intensity = Color(10)})},
      {"spot", light_of(SpotLight{.position = {1, 2.5f, 1},
                                  .direction = glm::normalize(Vec3(-1, -2, -1)),
                                  .intensity = Color(20),
                                  .inner_angle_rad = 0.3f,
                                  .outer_angle_rad = 0.6f})},
      {"directional", light_of(DirectionalLight{.direction = glm::normalize(Vec3(-1, -2, -1)), .irradiance = Color(3)})},
      {"rectangle",
       light_of(RectangleLight{.center = {0.5f, 2.5f, 1}, .half_u = {0.5f, 0, 0}, .half_v = {0, 0, 0.5f}, .radiance = Color(10)})},
      {"disk", light_of(DiskLight{.center = {0.5f, 2.5f, 1}, .half_u = {0.5f, 0, 0}, .half_v = {0, 0, 0.7f}, .radiance = Color(10)})},
      {"sphere", light_of(SphereLight{.center = {0.5f, 2.5f, 1}, .radius = 0.4f, .radiance = Color(10)})},
  };
  for (const auto& [name, light] : lights) expect_same({.name = name, .scene = ball_under(light, diffuse)});
}

/// The same ball between floor and wall under a glowing ceiling, which the reference finds with any path.
Scene ball_below_ceiling(const SurfaceModel& model, const SurfaceModel& floor = DiffuseMaterial{.reflectance = Color(0.7f)}) {
  Scene scene = ball_under({}, model, floor);
  scene.lights.clear();
  builtin::add_mesh(scene, builtin::MeshBuilder().quad({-2, 3, -2}, {4, 0, 0}, {0, 0, 4}).build("ceiling"),
                    builtin::add_emitter(scene, "ceiling", Color(1, 0.9f, 0.7f)));
  return scene;
}

TEST(Bidirectional, AgreesWithTheReferenceOnEveryMaterial) {
  const Color tan{0.8f, 0.5f, 0.2f};
  ConductorMaterial gold;
  gold.eta = Color(0.143f, 0.374f, 1.442f);
  gold.k = Color(3.983f, 2.386f, 1.603f);
  ConductorMaterial brushed = gold;
  brushed.alpha_u = 0.3f, brushed.alpha_v = 0.1f;
  const std::pair<const char*, SurfaceModel> models[] = {
      {"mirror", gold},
      {"brushed metal", brushed},
      {"metal", MetallicRoughnessMaterial{.base_color = tan, .metallic = 1.f, .roughness = 0.4f}},
      {"paint", MetallicRoughnessMaterial{.base_color = tan, .metallic = 0.f, .roughness = 0.3f}},
      {"smooth paint", MetallicRoughnessMaterial{.base_color = tan, .metallic = 0.f, .roughness = 0.f}},
      {"glass", DielectricMaterial{.eta = 1.5f}},
      {"rough glass", DielectricMaterial{.eta = 1.5f, .alpha_u = 0.2f, .alpha_v = 0.2f}},
      {"pane", DielectricMaterial{.eta = 1.5f, .thin = true}},
      {"smooth coat", CoatedDiffuseMaterial{.reflectance = tan, .eta = 1.5f}},
      {"rough coat", CoatedDiffuseMaterial{.reflectance = tan, .eta = 1.5f, .alpha_u = 0.2f, .alpha_v = 0.2f}},
      {"phong", PhongMaterial{.diffuse = 0.5f * tan, .specular = Color(0.4f), .exponent = 30.f}},
      {"paper", DiffuseTransmissionMaterial{.reflectance = 0.6f * tan, .transmittance = 0.3f * tan}},
  };
  for (const auto& [name, model] : models) expect_same({.name = name, .scene = ball_below_ceiling(model), .max_bounces = 6});
  for (const auto& [name, model] : models)
    expect_same(
        {.name = std::string(name) + " floor", .scene = ball_below_ceiling(DiffuseMaterial{.reflectance = tan}, model), .max_bounces = 3});
}

TEST(Bidirectional, AgreesWithTheReferenceOnMixturesMediaAndShadingNormals) {
  {
    Scene scene = ball_below_ceiling(DielectricMaterial{.eta = 1.3f});
    scene.media.push_back({.name = "ink", .sigma_a = Color(0.2f, 0.8f, 1.5f)});
    scene.materials[2].interior = MediumId(0);
    expect_same({.name = "ink", .scene = scene, .max_bounces = 6});
    scene.materials[2].model = DielectricMaterial{.eta = 1.3f, .alpha_u = 0.2f, .alpha_v = 0.2f};
    expect_same({.name = "ink in rough glass", .scene = scene, .max_bounces = 6});
  }
  {
    Scene scene = ball_below_ceiling(DiffuseMaterial{});
    const MaterialId first = builtin::add_diffuse(scene, "first", Color(0.9f, 0.1f, 0.1f));
    const MaterialId second = builtin::add_material(scene, "second", ConductorMaterial{.alpha_u = 0.2f, .alpha_v = 0.2f});
    scene.materials[2].model = MixMaterial{.first = first, .second = second, .amount = 0.4f};
    expect_same({.name = "mix", .scene = scene});
  }
  for (const bool glossy : {false, true}) {
    // A coarse ball whose vertex normals make it look smooth.
    Scene scene = ball_below_ceiling(DiffuseMaterial{});
    scene.spheres.clear();
    const MaterialId material = glossy ? builtin::add_material(scene, "coat", CoatedDiffuseMaterial{.alpha_u = 0.3f, .alpha_v = 0.3f})
                                       : builtin::add_diffuse(scene, "diffuse", Color(0.8f));
    Mesh mesh = builtin::MeshBuilder().ball(Vec3(0), 0.8f, 5).build("coarse");
    std::vector<Vec3> normals;
    for (const Vec3& p : mesh.positions) normals.push_back(glm::normalize(p));
    mesh.normals = SharedArray<Vec3>(std::move(normals));
    builtin::add_mesh(scene, std::move(mesh), material);
    scene.instances.back().world_from_object[3] = Vec4(0, 0.8f, 0, 1);
    expect_same({.name = glossy ? "glossy shading normals" : "shading normals", .scene = scene});
  }
}

TEST(Bidirectional, AgreesWithTheReferenceThroughEveryCamera) {
  const Scene scene = ball_below_ceiling(DielectricMaterial{.eta = 1.5f});
  Scene lens = scene;
  lens.cameras[0].lens_radius = 0.2f, lens.cameras[0].focal_distance = 3;
  Scene orthographic = scene;
  orthographic.cameras[0].projection = Camera::Projection::orthographic;
  orthographic.cameras[0].ortho_height = 3;
  Scene mirrored = scene;
  mirrored.cameras[0].world_from_camera[0] = -mirrored.cameras[0].world_from_camera[0];
  expect_same({.name = "thin lens", .scene = lens});
  expect_same({.name = "orthographic", .scene = orthographic});
  expect_same({.name = "mirrored", .scene = mirrored});
  expect_same({.name = "box filter", .scene = scene, .filter = PixelFilter::Kind::box});
  expect_same({.name = "pixel centres", .scene = scene, .spp = 32, .filter = PixelFilter::Kind::centre});
}

// Large pixels, since the reference needs many paths to find the caustic below the glass ball and the mirror's on the wall.
TEST(Bidirectional, AgreesWithTheReferenceOnCaustics) {
  expect_same({.name = "glass",
               .scene = builtin_scene("glass"),
               .max_bounces = 6,
               .reference_spp = 4096,
               .spp = 128,
               .brightest = 200,
               .size_px = {4, 4}});
  const Light sun = light_of(SphereLight{.center = {1, 2.7f, 1}, .radius = 0.3f, .radiance = Color(10)});
  Scene scene = ball_under(sun, DielectricMaterial{.eta = 1.5f});
  scene.lights.clear();
  builtin::add_sphere(scene, "lamp", {1, 2.7f, 1}, 0.3f, builtin::add_emitter(scene, "lamp", Color(10)));
  expect_same({.name = "lamp and glass ball",
               .scene = scene,
               .max_bounces = 5,
               .reference_spp = 2048,
               .spp = 64,
               .brightest = 100,
               .size_px = {6, 5}});
}

TEST(Bidirectional, SettingsDoNotChangeThePicture) {
  const Scene scene = ball_below_ceiling(DielectricMaterial{.eta = 1.5f});
  for (const char* setting : {"heuristic=balance", "light_image=false", "roulette_start=0"})
    expect_same({.name = setting, .scene = scene, .max_bounces = 6, .spp = 32, .settings = {setting}});
  for (const int bounces : {0, 1, 2}) expect_same({.name = std::to_string(bounces) + " bounces", .scene = scene, .max_bounces = bounces});
}

}  // namespace
}  // namespace sightline::test
