// The white furnace through the whole renderer: under a sky of radiance 1 a convex object shows its directional albedo.
#include <gtest/gtest.h>

#include <cmath>

#include "methods/reference/settings.h"
#include "scene/builtin/parts.h"
#include "shade/bsdf_albedo.h"
#include "shade/material_eval.h"
#include "support/chi_square.h"
#include "support/effort.h"
#include "support/picture_statistics.h"

namespace sightline::test {
namespace {

struct Case {
  std::string name;
  SurfaceModel model;
};

std::vector<Case> models() {
  const Color tan{0.8f, 0.5f, 0.2f};
  ConductorMaterial gold;
  gold.eta = Color(0.143f, 0.374f, 1.442f);
  gold.k = Color(3.983f, 2.386f, 1.603f);
  gold.alpha_u = 0.3f, gold.alpha_v = 0.15f;
  return {
      {"white diffuse", DiffuseMaterial{.reflectance = Color(1)}},
      {"diffuse", DiffuseMaterial{.reflectance = tan}},
      {"metallic-roughness, metal", MetallicRoughnessMaterial{.base_color = tan, .metallic = 1.f, .roughness = 0.4f}},
      {"metallic-roughness, paint", MetallicRoughnessMaterial{.base_color = tan, .metallic = 0.f, .roughness = 0.6f}},
      {"conductor", gold},
      {"smooth dielectric", DielectricMaterial{.eta = 1.5f}},
      {"rough dielectric", DielectricMaterial{.eta = 1.5f, .alpha_u = 0.3f, .alpha_v = 0.3f}},
      {"thin dielectric", DielectricMaterial{.eta = 1.5f, .thin = true}},
      {"smooth coat", CoatedDiffuseMaterial{.reflectance = tan, .eta = 1.5f}},
      {"rough coat", CoatedDiffuseMaterial{.reflectance = tan, .eta = 1.5f, .alpha_u = 0.2f, .alpha_v = 0.2f}},
      {"phong", PhongMaterial{.diffuse = 0.5f * tan, .specular = Color(0.4f), .exponent = 50.f}},
      {"diffuse transmission", DiffuseTransmissionMaterial{.reflectance = 0.6f * tan, .transmittance = 0.3f * tan}},
  };
}

/// A square in the plane z = 0 under a sky of radiance 1 all around, seen from where the cosine to its normal is `cos_o`.
Scene square(const SurfaceModel& model, float cos_o) {
  Scene scene;
  const MaterialId material = builtin::add_material(scene, "furnace", model);
  builtin::add_mesh(scene, builtin::MeshBuilder().quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}).build("square"), material);
  scene.environment = Environment{};
  builtin::add_camera(scene, 3.f * Vec3(std::sqrt(1 - cos_o * cos_o), 0, cos_o), Vec3(0), 10);
  return scene;
}

Color quadrature(const Shot& shot, const Vec3& normal, const Vec3& outgoing, float u_mix = 0) {
  const World& world = *shot.world;
  const Bsdf bsdf = make_bsdf(world.scene(), world.textures(), MaterialId(0), {}, u_mix);
  // The frame's tangent matters to anisotropic lobes: the square's is +x (its u), of a sphere's lobes all are isotropic.
  const Vec3 local = frame_from_normal_tangent(normal, {1, 0, 0}).to_local(outgoing);
  return integrate_directional_albedo(bsdf, local, TransportMode::radiance, 1e-5f).total();
}

constexpr float kCosines[] = {0.97f, 0.6f, 0.2f, -0.3f, -0.9f};

TEST(Furnace, EveryModelShowsItsDirectionalAlbedo) {
  for (const Case& c : models()) {
    for (const float cos_o : kCosines) {
      const Shot shot = shot_of(square(c.model, cos_o), {1, 1});
      Vec3 origin, direction;
      centre_ray(shot, 0, origin, direction);
      const Color truth = quadrature(shot, {0, 0, 1}, -direction);
      const Replicates seen = replicate(shot, {.spp = 4096 / kFewer, .max_bounces = 2}, 24);
      for (int k = 0; k < 3; ++k) {
        EXPECT_LE(seen.error[0][k], 1e-3 * kCoarser) << c.name << ", cos " << cos_o;
        EXPECT_NEAR(seen.mean[0][k], truth[k], 4 * seen.error[0][k] + 1e-4) << c.name << ", cos " << cos_o;
      }
    }
  }
}

TEST(Furnace, MixShowsTheMeanOfItsParts) {
  Scene scene = square(DiffuseMaterial{.reflectance = Color(0.9f)}, 0.5f);
  const MaterialId first = builtin::add_diffuse(scene, "first", Color(0.2f, 0.4f, 0.6f));
  const MaterialId second = builtin::add_diffuse(scene, "second", Color(0.9f, 0.5f, 0.1f));
  scene.materials[0].model = MixMaterial{.first = first, .second = second, .amount = 0.25f};
  const Replicates seen = replicate(shot_of(scene, {1, 1}), {.spp = 1024 / kFewer, .max_bounces = 2}, 16);
  const Vec3d truth = 0.75 * Vec3d(0.2, 0.4, 0.6) + 0.25 * Vec3d(0.9, 0.5, 0.1);
  for (int k = 0; k < 3; ++k) {
    EXPECT_LE(seen.error[0][k], 1e-3 * kCoarser);
    EXPECT_NEAR(seen.mean[0][k], truth[k], 4 * seen.error[0][k] + 1e-4);
  }
}

TEST(Furnace, InterfaceIsInvisible) {
  for (const float cos_o : kCosines) {
    const Picture picture = expose(shot_of(square(InterfaceMaterial{}, cos_o), {1, 1}), {.spp = 4});
    EXPECT_NEAR(picture.frame.color(0).y, 1, 1e-4);
  }
}

TEST(Furnace, BsdfSamplingOfLambertHasNoVariance) {
  for (const char* shape : {"sphere", "mesh"}) {
    for (const float albedo : {1.f, 0.7f}) {
      const std::string spec = "furnace,shape=" + std::string(shape) + ",albedo=" + std::to_string(albedo);
      const Shot shot = shot_of(builtin_scene(spec), {24, 24});
      const Picture picture = expose(shot, {.spp = 2, .bsdf_only = true, .aovs = parse_aovs("surface")});
      for (std::uint32_t pixel = 0; pixel < 24 * 24; ++pixel) {
        const bool object = picture.frame.value(Aov::surface, pixel).x > 0;
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(picture.frame.color(pixel)[k], object ? albedo : 1, 1e-4) << spec << " pixel " << pixel;
      }
    }
  }
}

TEST(Furnace, MirrorAndSmoothGlassReturnEverything) {
  // Radiance is compressed by 1/eta² in glass and expanded again on the way out, so roulette would add variance. A ray that enters a ball
  // comes out after a few inner reflections; in a polyhedron those that graze may be caught by total reflection for longer than any number
  // of bounces, so its rim is left out.
  for (const char* model : {"conductor", "dielectric"}) {
    for (const char* shape : {"sphere", "mesh"}) {
      const std::string spec = "furnace,albedo=1,roughness=0,model=" + std::string(model) + ",shape=" + shape;
      const Shot shot = shot_of(builtin_scene(spec), {24, 24});
      const Picture picture =
          expose(shot, {.settings = {"roulette_start=100000"}, .spp = 8, .max_bounces = 60, .aovs = parse_aovs("normal")});
      for (std::uint32_t pixel = 0; pixel < 24 * 24; ++pixel) {
        const Vec3 normal = picture.frame.value(Aov::normal, pixel);
        if (std::string_view(shape) == "mesh" && !is_black(normal) && normal.z < 0.75f) continue;
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(picture.frame.color(pixel)[k], 1, 1e-4) << spec << " pixel " << pixel;
      }
    }
  }
}

TEST(Furnace, RouletteDoesNotChangeTheMean) {
  const Shot shot = shot_of(builtin_scene("furnace,albedo=1,roughness=0,model=dielectric"), {8, 8});
  const Replicates seen = replicate(shot, {.settings = {"roulette_start=0"}, .spp = 128, .max_bounces = 60}, 24);
  const PictureTest test = compare(seen, std::vector<Vec3d>(64, Vec3d(1)));
  EXPECT_GT(test.pixel_p, 1e-3) << test.worst;
  EXPECT_GT(test.mean_p, 1e-3) << test.worst;
  EXPECT_LE(seen.picture_error.y, 1e-3);
}

/// Convex balls, exact and triangulated: each pixel has its own normal and its own albedo.
TEST(Furnace, BallsShowTheirDirectionalAlbedoInEveryPixel) {
  for (const char* shape : {"sphere", "mesh"}) {
    for (const char* model : {"diffuse,albedo=1", "metallic-roughness", "conductor,albedo=0.9", "coated-diffuse,roughness=0.3", "phong"}) {
      const std::string spec = "furnace,shape=" + std::string(shape) + ",model=" + model;
      const Shot shot = shot_of(builtin_scene(spec), {6, 6});
      const Picture guide = expose(shot, {.spp = 1, .aovs = parse_aovs("normal")});
      std::vector<Vec3d> truth(36, Vec3d(1));
      for (std::uint32_t pixel = 0; pixel < 36; ++pixel) {
        const Vec3 normal = guide.frame.value(Aov::normal, pixel);
        Vec3 origin, direction;
        centre_ray(shot, pixel, origin, direction);
        if (!is_black(normal)) truth[pixel] = Vec3d(quadrature(shot, glm::normalize(normal), -direction));
      }
      const Replicates seen = replicate(shot, {.spp = 1024 / kFewer, .max_bounces = 1}, 24);
      // The quadrature's own tolerance, where the estimate has less scatter than that.
      Replicates widened = seen;
      for (Vec3d& error : widened.error) error = glm::sqrt(error * error + Vec3d(2e-5 * 2e-5));
      const PictureTest test = compare(widened, truth);
      EXPECT_GT(test.pixel_p, 1e-3) << spec << ": " << test.worst;
      EXPECT_GT(test.mean_p, 1e-3) << spec << ": " << test.worst;
      double largest = 0;
      for (const Vec3d& error : seen.error) largest = std::fmax(largest, error.y);
      EXPECT_LE(largest, 1e-3 * kCoarser) << spec;
    }
  }
}

/// Inside a ball of diffuse transmission the radiance is the same everywhere: tau / (1 - rho).
TEST(Furnace, TranslucentBallShowsTheSumOfItsInnerReflections) {
  const Shot shot = shot_of(builtin_scene("furnace,model=diffuse-transmission,albedo=0.8"), {4, 4});
  const Picture guide = expose(shot, {.spp = 1, .aovs = parse_aovs("surface")});
  std::vector<Vec3d> truth(16, Vec3d(1));
  for (std::uint32_t pixel = 0; pixel < 16; ++pixel) {
    if (guide.frame.value(Aov::surface, pixel).x > 0) truth[pixel] = Vec3d(0.4 + 0.4 * 0.4 / (1 - 0.4));
  }
  const Replicates seen = replicate(shot, {.spp = 2048 / kFewer, .max_bounces = 40}, 32);
  const PictureTest test = compare(seen, truth);
  EXPECT_GT(test.pixel_p, 1e-3) << test.worst;
  EXPECT_GT(test.mean_p, 1e-3) << test.worst;
  for (const Vec3d& error : seen.error) EXPECT_LE(error.y, 1e-3 * kCoarser);
}

}  // namespace
}  // namespace sightline::test
