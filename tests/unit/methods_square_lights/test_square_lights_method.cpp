#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <vector>

#include "base/core/error.h"
#include "methods/square_lights/light_cube.h"
#include "methods/square_lights/square_bake.h"
#include "support/studio.h"

namespace sightline::test {
namespace {

/// A picture of surfaces; what shows the environment is black.
struct Taken {
  std::vector<Color> pixels;
  PassStatistics statistics;
};

Taken take(const Shot& shot, const std::vector<std::string>& settings, BakeStore& store, const std::string& method_name = "square-lights",
           int light_samples = 0) {
  const Method& method = find_method(method_name);
  Context context;
  context.threads = 2;
  RenderJob job;
  job.world = shot.world;
  job.settings = method.default_settings();
  for (const std::string& setting : settings) job.settings.apply(setting);
  const View view(shot.camera, shot.size_px, PixelFilter(PixelFilter::Kind::centre));
  job.view = &view;
  job.bakes = &store;
  job.max_bounces = 0, job.light_samples = light_samples;
  const VisibilityInfo& exact = find_visibility("exact");
  const auto visibility = exact.make(shot.world, exact.settings, context);
  job.visibility = visibility.get();
  const auto bake = method.prepare(job, context);
  job.bake = bake.get();
  AovSet aovs;
  aovs.add(Aov::alpha);
  Frame frame(shot.size_px.x, shot.size_px.y, aovs);
  Taken result;
  method.render_pass(job, {0, 1}, frame, result.statistics, context);
  for (std::uint32_t i = 0; i < view.pixel_count(); ++i)
    result.pixels.push_back(frame.value(Aov::alpha, i).x > 0 ? frame.color(i) : Color(0));
  return result;
}

double l2(const Taken& image, const Taken& truth) {
  double error = 0, sum = 0;
  for (std::size_t i = 0; i < truth.pixels.size(); ++i) {
    error += double{length_squared(image.pixels[i] - truth.pixels[i])};
    sum += double{length_squared(truth.pixels[i])};
  }
  return error / sum;
}

/// A cube map with a bright patch above and a dim half below, as picture and environment.
Environment patchy(int size) {
  auto image = std::make_shared<Image>();
  image->width = size, image->height = 6 * size, image->channels = 3;
  Image::Floats values;
  for (int face = 0; face < 6; ++face) {
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const Vec3 d = glm::normalize(cube_direction(face, cube_coordinate(x, size), cube_coordinate(y, size)));
        const float bright = glm::dot(d, glm::normalize(Vec3(1, 1.5f, 0.4f))) > 0.93f ? 12.f : 0.f;
        values.insert(values.end(), {bright + 0.3f + 0.2f * d.x, bright + 0.3f, 0.8f * bright + 0.4f - 0.2f * d.y});
      }
    }
  }
  image->data = std::move(values);
  Environment environment;
  environment.image = image, environment.mapping = EnvironmentMapping::cube, environment.name = "patchy";
  return environment;
}

const std::vector<std::string> kQuick{"cube=8", "rays=32", "occluder_rays=32"};
std::vector<std::string> quick(std::initializer_list<std::string> more) {
  std::vector<std::string> settings = kQuick;
  settings.insert(settings.end(), more);
  return settings;
}

/// Three balls over a net of vertices, all diffuse.
Scene small_scene() {
  Scene scene;
  scene.materials.push_back({.name = "white", .model = DiffuseMaterial{0.7f}});
  const MaterialId white(std::size_t{0});
  for (int k = 0; k < 3; ++k)
    scene.spheres.push_back(
        {.center = Vec3(1.6f * static_cast<float>(k) - 1.6f, 0.8f, 0.5f * static_cast<float>(k % 2)), .radius = 0.7f, .material = white});
  Mesh ground;
  std::vector<Vec3> positions;
  std::vector<UVec3> triangles;
  constexpr std::uint32_t n = 48;
  for (std::uint32_t z = 0; z <= n; ++z)
    for (std::uint32_t x = 0; x <= n; ++x)
      positions.emplace_back(static_cast<float>(x) * 6 / n - 3, 0.f, static_cast<float>(z) * 6 / n - 3);
  for (std::uint32_t z = 0; z < n; ++z) {
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t i = z * (n + 1) + x;
      triangles.push_back({i, i + n + 1, i + 1}), triangles.push_back({i + 1, i + n + 1, i + n + 2});
    }
  }
  ground.positions = positions, ground.triangles = triangles, ground.materials = {white};
  for (const Vec3& p : positions) ground.bounds.add(p);
  scene.meshes.push_back(ground);
  scene.instances.push_back({.name = "ground", .mesh = MeshId(std::size_t{0})});
  scene.environment = patchy(8);
  return scene;
}

Shot shot_with_camera(Scene scene, IVec2 size) {
  if (scene.cameras.empty()) scene.cameras.push_back(framing_camera(scene.framing.value_or(scene_bounds(scene))));
  return shot_of(std::move(scene), size);
}

TEST(SquareLights, WhatIsKeptOverFramesChangesNoPicture) {
  const auto picture = [](float exponent, BakeStore& store) {
    Scene scene = small_scene();
    scene.materials[0].model = PhongMaterial{Color(0.3f), Color(0.4f), exponent};
    return take(shot_with_camera(std::move(scene), {40, 30}), quick({}), store).pixels;
  };
  BakeStore kept, fresh;
  const auto first = picture(20, kept);
  EXPECT_EQ(picture(20, kept), first);
  const auto edited = picture(60, kept);
  EXPECT_NE(edited, first);
  EXPECT_EQ(edited, picture(60, fresh));
  EXPECT_EQ(picture(20, kept), first);
}

TEST(SquareLights, AllTexelsLightAnOpenSphereExactly) {
  Scene scene;
  scene.spheres.push_back({.center = Vec3(0), .radius = 1});
  scene.materials.push_back({.name = "white", .model = DiffuseMaterial{0.8f}});
  scene.spheres.front().material = MaterialId(std::size_t{0});
  scene.environment = patchy(16);
  const Shot shot = shot_with_camera(scene, {24, 24});
  BakeStore store;
  const Taken image = take(shot, std::vector<std::string>{"cube=16", "rays=32", "lights=all-tables"}, store),
              traced = take(shot, std::vector<std::string>{"cube=16", "lights=all"}, store);
  // Irradiance by the sum over 8 x 8 points of each texel.
  const auto exact = [&](const Vec3& n) {
    Color sum(0);
    constexpr int fine = 16 * 8;
    for (int face = 0; face < 6; ++face) {
      for (int y = 0; y < fine; ++y) {
        for (int x = 0; x < fine; ++x) {
          const Vec3 d = glm::normalize(cube_direction(face, cube_coordinate(x, fine), cube_coordinate(y, fine)));
          const float cosine = glm::dot(d, n);
          if (cosine > 0) sum += cube_texel_solid_angle(x, y, fine) * cosine * shot.world->lights().environment(d);
        }
      }
    }
    return 0.8f * kInvPi * sum;
  };
  int checked = 0;
  for (std::uint32_t i = 0; i < 24 * 24; i += 5) {
    Vec3 o, d;
    centre_ray(shot, i, o, d);
    const float b = glm::dot(o, d), c = length_squared(o) - 1, root = b * b - c;
    if (root < 0.05f) continue;
    const Color truth = exact(o + (-b - std::sqrt(root)) * d);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(image.pixels[i][k], truth[k], 0.015f * truth[k]) << i;
      EXPECT_NEAR(traced.pixels[i][k], truth[k], 0.015f * truth[k]) << i;
    }
    ++checked;
  }
  EXPECT_GT(checked, 15);
}

TEST(SquareLights, MoreLightsComeCloserToTheTruthWhichIsTheReference) {
  const Shot shot = shot_with_camera(small_scene(), {64, 48});
  BakeStore store;
  const Taken reference = take(shot, {}, store, "reference", 1024);
  const Taken truth = take(shot, quick({"lights=all"}), store);
  EXPECT_LT(l2(truth, reference), 2e-3) << "what is left is interpolation between vertices";
  const double ten = l2(take(shot, quick({"lights=10"}), store), truth), hundred = l2(take(shot, quick({"lights=100"}), store), truth);
  const double tables = l2(take(shot, quick({"lights=all-tables"}), store), truth);
  EXPECT_LT(hundred, 0.5 * ten);
  EXPECT_LT(hundred, 4e-3);
  EXPECT_LT(tables, 2e-3);
  EXPECT_LT(l2(take(shot, quick({"lights=10", "split=0.002"}), store), truth), 0.6 * ten);
  EXPECT_LT(l2(take(shot, quick({"basis=haar", "lights=384"}), store), truth), 1e-8) << "all terms are the truth";
}

TEST(SquareLights, CoverageByGradientIsNotItsMean) {
  const Shot shot = shot_with_camera(small_scene(), {48, 36});
  BakeStore store;
  for (const char* combine : {"combine=distance", "combine=product"}) {
    const Taken mean = take(shot, quick({"coverage=average", combine}), store),
                exact = take(shot, quick({"coverage=gradient", combine}), store);
    EXPECT_GT(l2(exact, mean), 1e-9) << combine;
    EXPECT_LT(l2(exact, mean), 1e-2) << combine;
  }
}

TEST(SquareLights, TurningTheEnvironmentIsTurningTheSceneBack) {
  const Scene scene = small_scene();
  const glm::mat4 turn = glm::rotate(glm::mat4(1), 0.7f, glm::normalize(Vec3(0.3f, 1, 0.2f)));
  Scene turned_light = scene, turned_scene = scene;
  turned_light.cameras = turned_scene.cameras = {framing_camera(scene_bounds(scene))};
  turned_light.environment->world_from_environment = Mat3(turn);
  const glm::mat4 back = glm::transpose(turn);
  for (Instance& instance : turned_scene.instances) instance.world_from_object = back * instance.world_from_object;
  for (Sphere& sphere : turned_scene.spheres) sphere.center = transform_point(back, sphere.center);
  turned_scene.cameras[0].world_from_camera = back * turned_scene.cameras[0].world_from_camera;
  // Without spheres, whose nets have poles that do not turn with the scene; a tent over the ground instead.
  for (Scene* s : {&turned_light, &turned_scene}) {
    s->spheres.clear();
    std::vector<Vec3> bent(s->meshes[0].positions.begin(), s->meshes[0].positions.end());
    for (Vec3& p : bent) p.y = std::max(0.f, 1.5f - std::fabs(p.x) - 0.7f * std::fabs(p.z));
    s->meshes[0].positions = bent;
  }
  BakeStore store;
  const Taken a = take(shot_of(turned_light, {48, 36}), kQuick, store), b = take(shot_of(turned_scene, {48, 36}), kQuick, store);
  // Tables are traced anew in the turned scene: a ray in some thousand falls to the other side of an edge.
  EXPECT_LT(l2(a, b), 1e-8);
}

TEST(SquareLights, MovingObjectsBakesAreTheirOwn) {
  Scene scene = small_scene();
  scene.spheres.clear();
  // Two wedges that float above the ground.
  Mesh plate;
  plate.name = "wedge";
  plate.positions = std::vector<Vec3>{{-1, 0, -1}, {1, 0, -1}, {0, 0, 1}, {0, 1, 0}};
  plate.triangles = std::vector<UVec3>{{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
  for (const Vec3& p : plate.positions) plate.bounds.add(p);
  scene.meshes.push_back(plate);
  for (int k = 0; k < 2; ++k) {
    Node node;
    node.name = k == 0 ? "left" : "right";
    node.translation_track.times_s = {0, 1};
    node.translation_track.values = {{-2.f + 3.f * static_cast<float>(k), 1.5f, 0, 0}, {-1.f + 3.f * static_cast<float>(k), 2, 1, 0}};
    scene.nodes.push_back(node);
    scene.instances.push_back({.name = node.name, .mesh = MeshId(scene.meshes.size() - 1), .node = NodeId(scene.nodes.size() - 1)});
  }
  scene.cameras = {framing_camera(scene_bounds(scene))};
  BakeStore store;
  const Taken first = take(shot_of(pose(scene, 0), {32, 24}), kQuick, store);
  EXPECT_EQ(first.statistics.rays.occlusion, 0u);
  EXPECT_GT(first.statistics.method_statistics.at("bake_rays"), 0);
  const auto made = [&] {
    std::size_t count = 0;
    for (const BakeStore::Event& event : store.events()) count += event.what != BakeStore::Event::What::found;
    return count;
  };
  // Light, ground, and as both wedges are alike one table and one field.
  const std::size_t before = made();
  EXPECT_EQ(before, 4u);
  const Taken second = take(shot_of(pose(scene, 0.6f), {32, 24}), kQuick, store);
  EXPECT_EQ(made(), before);
  EXPECT_EQ(second.statistics.method_statistics.at("bake_rays"), 0);
  EXPECT_EQ(second.statistics.rays.occlusion, 0u);
  EXPECT_EQ(second.statistics.rays.closest, 32u * 24u);
  EXPECT_GT(l2(second, first), 1e-4);
}

TEST(SquareLights, TooLittleMemoryIsSaidBeforeAnythingIsMade) {
  const Shot shot = shot_with_camera(small_scene(), {8, 8});
  const Method& method = find_method("square-lights");
  Context context;
  context.memory_budget_bytes = 1;
  RenderJob job;
  job.world = shot.world;
  job.settings = method.default_settings();
  BakeStore store;
  job.bakes = &store;
  try {
    method.prepare(job, context);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::resource);
  }
  EXPECT_TRUE(store.events().empty());
}

TEST(SquareLights, SettingsThatMakeNoSenseAreRefused) {
  using square_lights::LightChoice;
  EXPECT_EQ(square_lights::parse_lights("40").count, 40u);
  EXPECT_EQ(square_lights::parse_lights("all").kind, LightChoice::Kind::all);
  for (const char* text : {"", "0", "-3", "many", "30x", "99999999"}) EXPECT_THROW(square_lights::parse_lights(text), Error) << text;
}

}  // namespace
}  // namespace sightline::test
