// A coarse ball with smooth normals, lit from the side: with the option its light ends where the normals say, without it at the facets.
#include <gtest/gtest.h>

#include <cmath>

#include "film/view.h"
#include "scene/builtin/parts.h"
#include "support/studio.h"
#include "visibility/visibility.h"

namespace sightline::test {
namespace {

const Vec3 kTowardsLight = glm::normalize(Vec3(1, 0.25f, 0.1f));
constexpr std::uint32_t kSize = 64;

Scene coarse_ball() {
  Scene scene;
  Mesh mesh = builtin::MeshBuilder().ball(Vec3(0), 1, 7).build("coarse");
  std::vector<Vec3> normals;
  for (const Vec3& p : mesh.positions) normals.push_back(glm::normalize(p));
  mesh.normals = SharedArray<Vec3>(std::move(normals));
  builtin::add_mesh(scene, std::move(mesh), builtin::add_diffuse(scene, "ball", Color(0.8f)));
  scene.lights.push_back({.name = "sun", .shape = DirectionalLight{.direction = -kTowardsLight, .irradiance = Color(2)}, .node = {}});
  builtin::add_camera(scene, {0, 0, 5}, Vec3(0), 26);
  return scene;
}

Shot shot_with(const Scene& scene, bool shadow_terminator) {
  WorldOptions options;
  options.shadow_terminator = shadow_terminator;
  return {World::build(scene, options, Context()), scene.cameras[0], IVec2(kSize, kSize)};
}

struct Count {
  int grazing = 0, wrong = 0;  ///< of the pixels that the sun grazes, those that are not what the normals make of them
};

Count count(const Shot& shot, const Picture& picture) {
  Count result;
  const View view(shot.camera, shot.size_px, PixelFilter(PixelFilter::Kind::centre));
  for (std::uint32_t pixel = 0; pixel < kSize * kSize; ++pixel) {
    if (picture.frame.value(Aov::surface, pixel).x == 0) continue;
    const Vec3 normal = glm::normalize(picture.frame.value(Aov::normal, pixel));
    const float cosine = glm::dot(normal, kTowardsLight);
    // Where the normal does not see the camera it gives way to the facet's.
    Vec3 origin, direction;
    centre_ray(shot, pixel, origin, direction);
    if (std::fabs(cosine) > 0.4f || glm::dot(direction, normal) > -0.15f) continue;
    const float expected = 0.8f * kInvPi * 2 * std::fmax(cosine, 0.f);
    ++result.grazing;
    result.wrong += std::fabs(picture.frame.color(pixel).y - expected) > 0.01f * expected + 1e-4f;
  }
  return result;
}

TEST(ShadowTerminator, LightEndsWhereTheNormalsSay) {
  const Shot without = shot_with(coarse_ball(), false), with = shot_with(coarse_ball(), true);
  for (const char* method : {"reference", "bidirectional", "visibility-cache"}) {
    const Exposure exposure{.method = method, .spp = 1, .max_bounces = 0, .aovs = parse_aovs("normal,surface")};
    const Count facets = count(without, expose(without, exposure)), smooth = count(with, expose(with, exposure));
    EXPECT_GT(facets.grazing, 300) << method;
    EXPECT_GT(facets.wrong, facets.grazing / 15) << method;
    EXPECT_EQ(smooth.grazing, facets.grazing) << method;
    EXPECT_LE(smooth.wrong, smooth.grazing / 100) << method << " of " << smooth.grazing;
  }
}

TEST(ShadowTerminator, WhatStandsInTheLightStillCastsItsShadow) {
  Scene scene = coarse_ball();
  builtin::add_mesh(scene, builtin::MeshBuilder().box(4.f * kTowardsLight, Vec3(0.1f, 3, 3)).build("screen"),
                    builtin::add_diffuse(scene, "screen", Color(0)));
  const Shot shot = shot_with(scene, true);
  const Picture picture = expose(shot, {.spp = 1, .max_bounces = 0});
  for (std::uint32_t pixel = 0; pixel < kSize * kSize; ++pixel) EXPECT_EQ(picture.frame.color(pixel), Vec3(0)) << pixel;
}

// The same rays, whoever traces them.
TEST(ShadowTerminator, QueriesBeginWhereTheReferencesRaysDo) {
  const Shot shot = shot_with(coarse_ball(), true);
  const View view(shot.camera, shot.size_px, PixelFilter(PixelFilter::Kind::centre));
  const Picture exact = expose(shot, {.spp = 1, .max_bounces = 0});
  const Method& method = find_method("reference");
  const VisibilityInfo& info = find_visibility("cached");
  SettingsValue settings = info.settings;
  settings.apply("ce=1");
  const Context context;
  const std::unique_ptr<Visibility> cached = info.make(shot.world, settings, context);
  RenderJob job;
  job.world = shot.world, job.view = &view, job.visibility = cached.get();
  job.settings = method.default_settings();
  job.max_bounces = 0, job.total_spp = 1;
  Picture picture{empty_frame(shot, {}), {}};
  method.render_pass(job, {0, 1}, picture.frame, picture.statistics, context);
  int different = 0;
  for (std::uint32_t pixel = 0; pixel < kSize * kSize; ++pixel)
    different += std::fabs(picture.frame.color(pixel).y - exact.frame.color(pixel).y) > 1e-4;
  EXPECT_LE(different, 8);
}

}  // namespace
}  // namespace sightline::test
