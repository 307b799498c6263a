// Eye paths begin as the reference's do, branch at glass, and see what shines.
#include "methods/visibility_cache/eye_paths.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "shade/fresnel.h"
#include "support/studio.h"
#include "unit/methods_visibility_cache/eye_scenes.h"

namespace sightline {
namespace {

using namespace test;

std::shared_ptr<const World> world_of(const Scene& scene) { return World::build(scene, {}, Context()); }

AovSet first_hit_layers() { return parse_aovs("albedo,normal,position,depth,surface,alpha"); }

// Materials that random numbers choose, smooth normals, a background and a camera with a lens.
Scene mixed_scene() {
  Scene scene;
  const MaterialId red = add_material(scene, DiffuseMaterial{ColorParam{Color(0.8f, 0.1f, 0.1f)}});
  const MaterialId metal = add_material(scene, MetallicRoughnessMaterial{});
  const MaterialId mix = add_material(scene, MixMaterial{red, metal, FloatParam{0.3f}});
  place(scene, smooth_sphere({-1, 0, -5}, 1, 6), add_material(scene, MixMaterial{mix, add_material(scene, PhongMaterial{}), 0.5f}));
  place_sphere(scene, {1, 0, -5}, 1, mix);
  place(scene, box_mesh({-3, -1, -4}, {3, -0.7f, -2}), add_material(scene, InterfaceMaterial{}));
  scene.environment = Environment{};
  Camera camera = camera_at(Vec3(0), {0, 0, -1}, 0.7f);
  camera.lens_radius = 0.1f, camera.focal_distance = 4;
  scene.cameras = {camera};
  return scene;
}

TEST(EyePaths, FirstHitsAreTheReferences) {
  for (const char* name : {"spheres", "glass", "cornell", "mixed"}) {
    SCOPED_TRACE(name);
    const Shot shot = shot_of(name == std::string("mixed") ? mixed_scene() : builtin_scene(name), {45, 37});
    Exposure exposure;
    exposure.spp = 4, exposure.seed = 7, exposure.max_bounces = 0, exposure.filter = PixelFilter::Kind::gaussian;
    exposure.aovs = first_hit_layers();
    const Picture reference = expose(shot, exposure);
    Take how;
    how.size_px = shot.size_px, how.filter = exposure.filter, how.range = {0, 4}, how.pass_samples = 4, how.options.seed = 7;
    how.aovs = exposure.aovs;
    const Taken taken = take(*shot.world, shot.camera, how);
    for (const Aov aov : {Aov::albedo, Aov::normal, Aov::position, Aov::depth, Aov::surface, Aov::alpha})
      EXPECT_TRUE(std::ranges::equal(taken.frame.sums(aov), reference.frame.sums(aov))) << static_cast<int>(aov);
  }
}

TEST(EyePaths, PathsStandBlockByBlockAndSamplesInTheirOrder) {
  Scene scene;
  place(scene, square({0, 0, -5}, {0, 0, 1}, 50));
  place(scene, square({0, 0, -2}, {0, 0, 1}, 0.5f), add_material(scene, DielectricMaterial{}));
  place(scene, square({0, 0, 5}, {0, 0, -1}, 50));
  const auto world = world_of(scene);
  const View view(camera_at({0.1f, 0, 0}, {0, 0, -1}, 0.9f), {40, 7}, PixelFilter());
  Frame frame(40, 7, {});
  EyePaths eye_paths(*world, view, {});
  TilePaths paths;
  std::vector<EyeSample> samples;
  RayCounts rays;
  std::size_t branches = 0;
  for (std::size_t t = 0; t < frame.tile_count(); ++t) {
    const Tile tile = frame.tile(t);
    eye_paths.trace(tile, {3, 8}, 5, paths, samples, frame, rays);
    const int across = (tile.x1 - tile.x0 + 3) / 4;
    ASSERT_EQ(paths.count, static_cast<std::size_t>(across * 2 * 5 * 16));
    EXPECT_EQ(paths.samples, 5u);
    for (std::size_t i = 0; i < paths.count; ++i) {
      const int lane = static_cast<int>(i % 16), sample = static_cast<int>(i / 16 % 5), block = static_cast<int>(i / 80);
      const int x = tile.x0 + block % across * 4 + lane % 4, y = tile.y0 + block / across * 4 + lane / 4;
      EXPECT_EQ(paths.inside[i] != 0, x < tile.x1 && y < tile.y1);
      EXPECT_EQ(paths.sample[i], static_cast<std::uint32_t>(3 + sample));
      if (paths.inside[i]) {
        EXPECT_EQ(paths.pixel[i], static_cast<std::uint32_t>(y * 40 + x));
      }
    }
    std::set<std::uint32_t> ids;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      EXPECT_TRUE(paths.inside[samples[k].slot]);
      if (k > 0) {
        EXPECT_GE(samples[k].slot, samples[k - 1].slot);
      }
      EXPECT_TRUE(ids.insert(samples[k].id).second);
      EXPECT_NEAR(glm::length(samples[k].wo), 1, 1e-6f);
      EXPECT_GT(glm::dot(samples[k].wo, samples[k].geometric_normal), 0);
    }
    ASSERT_GE(samples.size(), static_cast<std::size_t>(tile.pixel_count() * 5));
    branches += samples.size() - static_cast<std::size_t>(tile.pixel_count() * 5);
  }
  EXPECT_GT(branches, 30u);
}

TEST(EyePaths, DoNotDependOnHowTheRangeIsCut) {
  const Shot shot = shot_of(builtin_scene("glass"), {33, 33});
  Take whole, part;
  whole.size_px = part.size_px = shot.size_px;
  whole.range = {0, 3}, whole.pass_samples = part.pass_samples = 3;
  const Taken a = take(*shot.world, shot.camera, whole);
  std::map<std::uint32_t, EyeSample> by_id;
  for (const Seen& seen : a.seen) by_id[seen.eye.id] = seen.eye;
  EXPECT_EQ(by_id.size(), a.seen.size());
  std::size_t found = 0;
  for (std::uint32_t s = 0; s < 3; ++s) {
    part.range = {s, s + 1};
    for (const Seen& seen : take(*shot.world, shot.camera, part).seen) {
      ASSERT_TRUE(by_id.contains(seen.eye.id));
      const EyeSample& other = by_id[seen.eye.id];
      EXPECT_EQ(other.position, seen.eye.position);
      EXPECT_EQ(other.weight, seen.eye.weight);
      EXPECT_EQ(other.area, seen.eye.area);
      ++found;
    }
  }
  EXPECT_EQ(found, a.seen.size());
}

// A pane between two walls.
Scene pane_scene(const SurfaceModel& pane) {
  Scene scene;
  place(scene, square({0, 0, -5}, {0, 0, 1}, 50));
  place(scene, square({0, 0, 5}, {0, 0, -1}, 50));
  place(scene, square({0, 0, -2}, {0, 0, 1}, 50), add_material(scene, pane));
  return scene;
}

TEST(EyePaths, APaneSplitsInTwo) {
  DielectricMaterial thin;
  thin.thin = true;
  const auto world = world_of(pane_scene(thin));
  const Camera camera = camera_at(Vec3(0), {0, 0, -1}, 0.9f);
  Take how;
  const Taken taken = take(*world, camera, how);
  ASSERT_EQ(taken.seen.size(), 2u * 64 * 64);
  for (std::size_t k = 0; k < taken.seen.size(); k += 2) {
    const EyeSample &back = taken.seen[k].eye, &front = taken.seen[k + 1].eye;
    EXPECT_EQ(taken.seen[k].pixel, taken.seen[k + 1].pixel);
    EXPECT_NEAR(back.position.z, 5, 1e-4f);
    EXPECT_NEAR(front.position.z, -5, 1e-4f);
    const float cosine = front.wo.z;
    const float r = fresnel_dielectric(cosine, 1.5f), both = 2 * r / (1 + r);
    EXPECT_NEAR(back.weight.x, both, 1e-5f);
    EXPECT_NEAR(front.weight.x, 1 - both, 1e-5f);
    EXPECT_LE(back.weight.x + front.weight.x, 1.000001f);
    EXPECT_NE(back.id, front.id);
    // The branch is the same for all paths that turn alike.
    EXPECT_NE(back.branch, front.branch);
    EXPECT_EQ(back.branch, taken.seen[0].eye.branch);
    EXPECT_EQ(front.branch, taken.seen[1].eye.branch);
    // Both walls are seen at a distance of their own: 5 straight on, and 2 there and 7 back.
    EXPECT_NEAR(std::sqrt(back.area / front.area), 9.f / 5, 1e-3f);
  }
  how.options.max_depth = 0;
  EXPECT_TRUE(take(*world, camera, how).seen.empty());
  how.options = {}, how.options.least_weight = 0.5f;
  EXPECT_EQ(take(*world, camera, how).seen.size(), 64u * 64);
}

TEST(EyePaths, DepthIsLimited) {
  // Two mirrors face each other and a wall is never found.
  const auto world = world_of([] {
    Scene scene;
    ConductorMaterial white;
    white.eta = ColorParam{0.f}, white.k = ColorParam{1e4f};
    const MaterialId mirror = add_material(scene, white);
    place(scene, square({0, 0, -1}, {0, 0, 1}, 100), mirror);
    place(scene, square({0, 0, 1}, {0, 0, -1}, 100), mirror);
    return scene;
  }());
  for (const int depth : {0, 1, 5}) {
    Take how;
    how.options.max_depth = depth;
    const Taken taken = take(*world, camera_at(Vec3(0), {0, 0, -1}, 0.1f), how);
    EXPECT_TRUE(taken.seen.empty());
    // Without anything that shines the ray after the last mirror need not be traced.
    EXPECT_EQ(taken.rays.closest, 64u * 64 * static_cast<std::uint64_t>(depth + 1)) << depth;
  }
}

// As in the reference, the last ray adds what shines and nothing else.
TEST(EyePaths, TheLastMirrorStillShowsLamps) {
  Scene scene;
  const MaterialId mirror = add_material(scene, ConductorMaterial{});
  place(scene, square({0, 0, -2}, {0, 0, 1}, 5), mirror);
  place(scene, square({0, 0, 4}, {0, 0, -1}, 50), add_material(scene, DiffuseMaterial{ColorParam{0.f}}, Color(3)));
  const Shot shot{world_of(scene), camera_at(Vec3(0), {0, 0, -1}, 0.4f), {8, 8}};
  for (const int depth : {-1, 0, 1}) {
    Take how;
    how.size_px = shot.size_px, how.options.max_depth = depth;
    const Taken taken = take(*shot.world, shot.camera, how);
    EXPECT_EQ(taken.seen.size(), depth > 0 ? 64u : 0u);
    Exposure exposure;
    exposure.spp = 1, exposure.max_bounces = depth;
    if (depth < 0) {
      EXPECT_EQ(taken.emitted[9], Color(0));
      continue;
    }
    const Picture reference = expose(shot, exposure);
    for (std::uint32_t pixel = 0; pixel < 64; ++pixel) EXPECT_LT(glm::length(taken.emitted[pixel] - reference.frame.color(pixel)), 1e-5f);
    EXPECT_GT(taken.emitted[9].x, 1);
  }
}

TEST(EyePaths, CoatsGiveASampleAndAMirror) {
  const auto world = world_of(pane_scene(CoatedDiffuseMaterial{}));
  const Taken taken = take(*world, camera_at(Vec3(0), {0, 0, -1}, 0.9f), {});
  ASSERT_EQ(taken.seen.size(), 2u * 64 * 64);
  for (std::size_t k = 0; k < taken.seen.size(); k += 2) {
    EXPECT_NEAR(taken.seen[k].eye.position.z, -2, 1e-4f);
    EXPECT_EQ(taken.seen[k].eye.weight, Color(1));
    EXPECT_EQ(taken.seen[k].eye.branch, 0u);
    EXPECT_NE(taken.seen[k + 1].eye.branch, 0u);
    EXPECT_NEAR(taken.seen[k + 1].eye.position.z, 5, 1e-4f);
    EXPECT_NEAR(taken.seen[k + 1].eye.weight.x, fresnel_dielectric(taken.seen[k].eye.wo.z, 1.5f), 1e-5f);
  }
}

TEST(EyePaths, InterfacesAreNotSeenButAbsorb) {
  Scene scene;
  place(scene, square({0, 0, -5}, {0, 0, 1}, 50));
  Medium medium;
  medium.sigma_a = {0.1f, 0.5f, 2};
  scene.media.push_back(medium);
  const MaterialId boundary = add_material(scene, InterfaceMaterial{});
  scene.materials.back().interior = MediumId(0);
  place(scene, box_mesh({-9, -9, -3}, {9, 9, -1}), boundary);
  const Taken taken = take(*world_of(scene), camera_at(Vec3(0), {0, 0, -1}, 0.9f), {});
  ASSERT_EQ(taken.seen.size(), 64u * 64);
  for (const Seen& seen : taken.seen) {
    EXPECT_NEAR(seen.eye.position.z, -5, 1e-4f);
    const float way = 2 / seen.eye.wo.z;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen.eye.weight[c], std::exp(-medium.sigma_a[c] * way), 1e-4f);
    // As through nothing.
    const float side = 2 * 5 * std::tan(0.45f) / 64;
    EXPECT_NEAR(seen.eye.area, side * side, 1e-3f * side * side);
  }
}

TEST(EyePaths, MirrorsThatTurnRaysBelowTheirSurfaceShowNothing) {
  for (const float tilt : {0.5f, 1.f}) {
    Scene scene;
    place(scene, square({0, 0, -9}, {0, 0, 1}, 50));
    place(scene, square({0, 0, 9}, {0, 0, -1}, 50));
    Mesh mirror = square({0, 0, -2}, {0, 0, 1}, 5);
    mirror.normals = std::vector<Vec3>(4, Vec3{std::sin(tilt), 0, std::cos(tilt)});
    place(scene, mirror, add_material(scene, ConductorMaterial{}));
    const Taken taken = take(*world_of(scene), camera_at(Vec3(0), {0, 0, -1}, 0.05f), {});
    // 2 * 1 rad is more than a right angle.
    EXPECT_EQ(taken.seen.size(), tilt > 0.8f ? 0u : 64u * 64);
    for (const Seen& seen : taken.seen) EXPECT_NEAR(seen.eye.position.z, 9, 1e-4f);
  }
}

TEST(EyePaths, WhatRefractionDoesToRadianceIsNoLoss) {
  Scene scene;
  place(scene, square({0, 0, -3}, {0, 0, 1}, 4));
  place(scene, box_mesh({-9, -9, -9}, {9, 9, -1}), add_material(scene, DielectricMaterial{}));
  Take how;
  how.options.least_weight = 0.5f;
  const Taken taken = take(*world_of(scene), camera_at(Vec3(0), {0, 0, -1}, 0.1f), how);
  ASSERT_EQ(taken.seen.size(), 64u * 64);
  for (const Seen& seen : taken.seen) EXPECT_NEAR(seen.eye.weight.x, 0.96f / 2.25f, 1e-3f);
}

// Glass, absorbing too, mirrors, a coat and emitters under a sky: what shines is seen only along deltas.
TEST(EyePaths, EmissionThroughGlassIsTheReferences) {
  Scene scene;
  const MaterialId glass = add_material(scene, DielectricMaterial{});
  Medium medium;
  medium.sigma_a = {0.1f, 0.5f, 2};
  scene.media.push_back(medium);
  scene.materials.back().interior = MediumId(0);
  place_sphere(scene, {-1, 0, -5}, 1, glass);
  place(scene, box_mesh({0.3f, -1, -6}, {1.6f, 1, -4.5f}), glass);
  const MaterialId lamp = add_material(scene, DiffuseMaterial{ColorParam{0.f}}, {3, 2, 1});
  place(scene, square({0, 0, -9}, {0, 0, 1}, 1.5f), lamp);
  place(scene, square({0, -1.5f, -5}, {0, 1, 0}, 3), add_material(scene, ConductorMaterial{}));
  Environment sky;
  sky.scale = {0.2f, 0.4f, 0.8f};
  scene.environment = sky;
  Shot shot{world_of(scene), camera_at(Vec3(0), {0, 0, -1}, 0.7f), {32, 32}};
  Exposure exposure;
  exposure.spp = 256, exposure.filter = PixelFilter::Kind::centre, exposure.max_bounces = 8;
  const Picture reference = expose(shot, exposure);
  Take how;
  how.size_px = shot.size_px, how.options.least_weight = 1e-4f;
  const Taken taken = take(*shot.world, shot.camera, how);
  Color sum(0), expected(0);
  for (std::uint32_t pixel = 0; pixel < 32 * 32; ++pixel) {
    sum += taken.emitted[pixel], expected += reference.frame.color(pixel);
    // 256 choices of lobe, radiances up to 3.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(taken.emitted[pixel][c], reference.frame.color(pixel)[c], 0.25f) << pixel;
  }
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c], expected[c], 0.005f * expected[c]);
}

}  // namespace
}  // namespace sightline
