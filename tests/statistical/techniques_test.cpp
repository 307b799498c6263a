// Different ways to estimate the same picture: light sampling, BSDF sampling, both; other tracers, other numbers of light samples.
#include <gtest/gtest.h>

#include "scene/builtin/parts.h"
#include "support/picture_statistics.h"

namespace sightline::test {
namespace {

constexpr double kFamily = 1e-3;

void expect_same(const Replicates& a, const Replicates& b, const std::string& what) {
  const PictureTest test = compare(a, b);
  EXPECT_GT(test.pixel_p, kFamily) << what << ": " << test.worst;
  EXPECT_GT(test.mean_p, kFamily) << what << ": " << test.worst;
}

/// builtin:spheres with all surfaces rough enough for light samples to see.
Scene rough_spheres() {
  Scene scene = builtin_scene("spheres");
  for (Material& material : scene.materials) {
    if (std::holds_alternative<DielectricMaterial>(material.model))
      material.model = DielectricMaterial{.eta = 1.5f, .alpha_u = 0.25f, .alpha_v = 0.25f};
    if (std::holds_alternative<CoatedDiffuseMaterial>(material.model))
      material.model = CoatedDiffuseMaterial{.reflectance = Color(0.15f, 0.45f, 0.2f), .eta = 1.5f, .alpha_u = 0.2f, .alpha_v = 0.2f};
  }
  return scene;
}

/// BSDF samples may all miss a small light: then their scatter says nothing. One more path that finds it is never a surprise.
Replicates with_one_more_path(Replicates replicates, double brightest, int samples) {
  for (Vec3d& error : replicates.error) error = glm::sqrt(error * error + Vec3d(brightest * brightest / (1.0 * samples * samples)));
  return replicates;
}

TEST(Techniques, LightSamplingBsdfSamplingAndBothAgree) {
  // With no indirect bounce all three estimate the same integral.
  const std::pair<const char*, Scene> scenes[] = {{"rough spheres", rough_spheres()}, {"cornell", builtin_scene("cornell")}};
  for (const auto& [name, scene] : scenes) {
    const Shot shot = shot_of(scene, {24, 18});
    const Replicates lights =
        replicate(shot, {.settings = {"mode=one-hit"}, .spp = 1, .light_samples = 256, .max_bounces = 0, .seed = 1}, 24);
    const Replicates bsdfs =
        with_one_more_path(replicate(shot, {.spp = 256, .max_bounces = 0, .bsdf_only = true, .seed = 2}, 24), 16, 256 * 24);
    const Replicates both = replicate(shot, {.spp = 256, .max_bounces = 0, .seed = 3}, 24);
    const Replicates both_often = replicate(shot, {.spp = 64, .light_samples = 4, .max_bounces = 0, .seed = 4}, 24);
    expect_same(lights, both, std::string(name) + ", light samples and both");
    expect_same(bsdfs, both, std::string(name) + ", BSDF samples and both");
    expect_same(lights, bsdfs, std::string(name) + ", light samples and BSDF samples");
    expect_same(lights, both_often, std::string(name) + ", light samples and both with 4 light samples");
  }
}

/// A floor, a ball and a light above that the camera does not see: as a mesh rays may hit it, as a RectangleLight only samples find it.
Scene lit_by(bool mesh) {
  Scene scene;
  builtin::add_mesh(scene, builtin::MeshBuilder().quad({-3, 0, -3}, {0, 0, 6}, {6, 0, 0}).build("floor"),
                    builtin::add_diffuse(scene, "floor", Color(0.8f, 0.6f, 0.4f)));
  builtin::add_sphere(
      scene, "ball", {0, 0.7f, 0}, 0.7f,
      builtin::add_material(scene, "ball", MetallicRoughnessMaterial{.base_color = Color(0.7f), .metallic = 1.f, .roughness = 0.5f}));
  if (mesh) {
    builtin::add_mesh(scene, builtin::MeshBuilder().quad({-1, 3, -0.5f}, {2, 0, 0}, {0, 0, 1}).build("light"),
                      builtin::add_emitter(scene, "light", Color(4, 5, 6)));
  } else {
    scene.lights.push_back(
        {.name = "light",
         .shape = RectangleLight{.center = {0, 3, 0}, .half_u = {1, 0, 0}, .half_v = {0, 0, 0.5f}, .radiance = Color(4, 5, 6)},
         .node = {}});
  }
  builtin::add_camera(scene, {0, 1.5f, 4}, {0, 0.4f, 0}, 40);
  return scene;
}

TEST(Techniques, InvisibleRectangleAndGlowingMeshLightAlike) {
  for (const int light_samples : {1, 4}) {
    const Exposure exposure{.spp = 64, .light_samples = light_samples, .max_bounces = 4};
    const Replicates invisible = replicate(shot_of(lit_by(false), {20, 15}), exposure, 24);
    Exposure other = exposure;
    other.seed = 7;
    expect_same(invisible, replicate(shot_of(lit_by(true), {20, 15}), other, 24), std::to_string(light_samples) + " light samples");
  }
}

// Camera and bounce rays pass a pane without a surface; so must shadow rays.
TEST(Techniques, AnInterfaceOnTheWayChangesNothing) {
  for (const bool mesh : {false, true}) {
    Scene with = lit_by(mesh);
    builtin::add_mesh(with, builtin::MeshBuilder().quad({-3, 2, -3}, {0, 0, 6}, {6, 0, 0}).build("pane"),
                      builtin::add_material(with, "pane", InterfaceMaterial{}));
    const Replicates bare = replicate(shot_of(lit_by(mesh), {12, 9}), {.spp = 64, .max_bounces = 0}, 16);
    expect_same(bare, replicate(shot_of(with, {12, 9}), {.spp = 64, .max_bounces = 0, .seed = 7}, 16),
                mesh ? "interface below a glowing mesh" : "interface below a light");
  }
}

TEST(Techniques, SeedsTracersAndLightSamplesDoNotChangeThePicture) {
  for (const char* name : {"glass", "veach-like"}) {
    const Shot shot = shot_of(builtin_scene(name), {20, 15});
    const Replicates reference = replicate(shot, {.spp = 48, .max_bounces = 6, .seed = 1}, 32);
    expect_same(reference, replicate(shot, {.spp = 48, .max_bounces = 6, .seed = 2}, 32), std::string(name) + ", another seed");
    expect_same(reference, replicate(shot, {.spp = 16, .light_samples = 4, .max_bounces = 6, .seed = 3}, 32),
                std::string(name) + ", 4 light samples");
    const Shot brute = shot_of(builtin_scene(name), {20, 15}, WorldOptions::Backend::brute);
    expect_same(reference, replicate(brute, {.spp = 24, .max_bounces = 6, .seed = 4}, 32), std::string(name) + ", brute force");
  }
}

TEST(Techniques, TracersGiveTheSamePictureWithEqualNumbers) {
  // The same random numbers: but for rays that graze an edge, both tracers see the same, so the pictures differ in few pixels.
  for (const char* name : {"glass", "cornell", "spheres"}) {
    const Exposure exposure{.spp = 4, .max_bounces = 3, .seed = 5};
    const Picture embree = expose(shot_of(builtin_scene(name), {48, 36}), exposure);
    const Picture brute = expose(shot_of(builtin_scene(name), {48, 36}, WorldOptions::Backend::brute), exposure);
    int different = 0;
    for (std::uint32_t pixel = 0; pixel < 48 * 36; ++pixel) {
      const Vec3 a = embree.frame.color(pixel), b = brute.frame.color(pixel);
      different += glm::length(a - b) > 1e-2f * glm::length(a + b) + 1e-4f;
    }
    EXPECT_LE(different, 48 * 36 / 50) << name;
  }
}

}  // namespace
}  // namespace sightline::test
