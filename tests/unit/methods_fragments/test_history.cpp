// Pictures of a moving camera that take over what the last one knows.
#include <gtest/gtest.h>

#include "base/core/error.h"
#include "methods/fragments/history.h"
#include "test_fragments_support.h"

namespace sightline::test {
namespace {

constexpr IVec2 kWalkSize{240, 160};
constexpr int kSteps = 8;

Picture of_walk(const Shot& shot, const std::vector<std::string>& settings, int threads = 2, std::uint64_t seed = 0) {
  return expose(shot, {.method = "fragments", .settings = settings, .spp = 1, .max_bounces = 0, .seed = seed, .threads = threads});
}
Camera walk_camera(int step) {
  const float t = 0.03f * static_cast<float>(step);
  return camera_at({2.5f - t, 2.5f, 3 + 0.7f * t}, {0.1f * t, 0.3f, 0}, 0.9f);
}
Shot seen_from(const Shot& shot, int step) { return {shot.world, walk_camera(step), shot.size_px}; }
Shot edited(const Shot& shot, Scene scene) { return {World::edit(*shot.world, std::move(scene), Context()), shot.camera, shot.size_px}; }

double squared_error(const Frame& frame, const Frame& truth) {
  double squared = 0, sum = 0;
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(frame.width() * frame.height()); ++i) {
    const Vec3d a(frame.color(i)), b(truth.color(i));
    squared += glm::dot(a - b, a - b), sum += glm::dot(b, b);
  }
  return squared / sum;
}

TEST(PictureProjections, FindThePixelOfEveryRay) {
  for (const auto projection : {Camera::Projection::perspective, Camera::Projection::orthographic}) {
    Camera camera = camera_at({1, 2, 3}, {0.2f, 0.1f, -1}, 0.8f);
    camera.projection = projection;
    const View view(camera, {64, 40}, PixelFilter(PixelFilter::Kind::centre));
    const PictureProjection pictures(view.pinhole());
    for (const Vec2 at : {Vec2(0, 0), Vec2(63.5f, 0.5f), Vec2(20.25f, 30.75f), Vec2(-3, 50)}) {
      Vec3 origin, direction;
      view.ray_through(at.x, at.y, Vec2(0), origin, direction);
      float x = 0, y = 0;
      ASSERT_TRUE(pictures.project(origin + 7.f * direction, x, y));
      EXPECT_NEAR(x, at.x, 1e-3f);
      EXPECT_NEAR(y, at.y, 1e-3f);
      EXPECT_FALSE(pictures.project(origin - 7.f * direction, x, y));
    }
  }
}

TEST(FragmentHistory, OfAMovingCameraSavesRaysAndKeepsTheError) {
  const Shot start = shot_of(box_on_floor(), kWalkSize);
  std::vector<Picture> pictures;
  for (int step = 0; step < kSteps; ++step) pictures.push_back(of_walk(seen_from(start, step), {"temporal=on"}));
  double rays = 0, rays_alone = 0, error = 0, error_alone = 0;
  for (int step = kSteps / 2; step < kSteps; ++step) {
    const Picture& picture = pictures[static_cast<std::size_t>(step)];
    EXPECT_GT(picture.statistics.method_statistics.at("kept_pixels"), 0);
    EXPECT_GT(picture.statistics.method_statistics.at("kept_fragments"), 0);
    const Shot shot = seen_from(start, step);
    const Picture alone = of_walk(shot, {"temporal=off"}, 2, static_cast<std::uint64_t>(step));
    const Frame truth = expose(shot, {.method = "reference", .spp = 1, .light_samples = 512, .max_bounces = 0}).frame;
    rays += static_cast<double>(picture.statistics.rays.occlusion), error += squared_error(picture.frame, truth);
    rays_alone += static_cast<double>(alone.statistics.rays.occlusion), error_alone += squared_error(alone.frame, truth);
  }
  EXPECT_LT(rays, 0.8 * rays_alone);
  EXPECT_LT(error, 1.3 * error_alone);
}

TEST(FragmentHistory, LeavesFirstPicturesAlone) {
  const Shot shot = shot_of(box_on_floor(), kWalkSize);
  const Picture without = of_walk(shot, {});
  EXPECT_TRUE(same_sums(of_walk(shot, {"temporal=on"}).frame, without.frame));
  EXPECT_FALSE(same_sums(of_walk(shot, {"temporal=on"}).frame, without.frame)) << "nothing was taken over";
  EXPECT_TRUE(same_sums(of_walk(shot, {}).frame, without.frame)) << "what was kept shows without temporal=on";
  EXPECT_TRUE(same_sums(of_walk(shot, {"temporal=on"}).frame, without.frame)) << "it was kept over a picture without temporal=on";
}

TEST(FragmentHistory, EndsWithEveryChangeOfLightGeometryOrSettings) {
  const Shot start = shot_of(box_on_floor(), kWalkSize);
  struct Edit {
    const char* name;
    void (*make)(Scene&);
  };
  const Edit changes[] = {
      {"light moved", [](Scene& s) { std::get<RectangleLight>(s.lights[0].shape).center.x += 0.2f; }},
      {"light brighter", [](Scene& s) { std::get<RectangleLight>(s.lights[0].shape).radiance *= 2.f; }},
      {"light added", [](Scene& s) { s.lights.push_back({.name = "second", .shape = lamp({-1, 3, 0}, 0.3f), .node = {}}); }},
      {"box moved", [](Scene& s) { s.instances[1].world_from_object[3].x += 0.3f; }},
      {"box gone", [](Scene& s) { s.instances.pop_back(); }},
  };
  for (const Edit& change : changes) {
    of_walk(start, {"temporal=on"});
    Scene scene = start.world->scene();
    change.make(scene);
    const Shot shot = edited(start, std::move(scene));
    const Picture with = of_walk(shot, {"temporal=on"});
    EXPECT_TRUE(same_sums(with.frame, of_walk(shot, {}).frame)) << change.name;
  }
  const auto fresh = [&](const std::vector<std::string>& settings, std::uint64_t seed) {
    of_walk(start, {"temporal=on"});
    std::vector<std::string> with = settings;
    with.push_back("temporal=on");
    const Picture picture = of_walk(start, with, 2, seed);
    return same_sums(picture.frame, of_walk(start, settings, 2, seed).frame);
  };
  EXPECT_TRUE(fresh({"smooth=off"}, 0));
  EXPECT_TRUE(fresh({}, 1));
}

TEST(FragmentHistory, GoesOnWhereAnEditLeavesLightAndGeometryAlone) {
  const Shot start = shot_of(box_on_floor(), kWalkSize);
  const Picture first = of_walk(start, {"temporal=on"});
  Scene scene = start.world->scene();
  scene.cameras[0] = walk_camera(1);
  const Shot shot = edited(start, std::move(scene));
  const Picture second = of_walk({shot.world, walk_camera(1), shot.size_px}, {"temporal=on"});
  EXPECT_LT(static_cast<double>(second.statistics.rays.occlusion), 0.85 * static_cast<double>(first.statistics.rays.occlusion));
}

TEST(FragmentHistory, IsTheSameForAnyNumberOfThreads) {
  std::vector<Picture> last;
  for (const int threads : {1, 2, 4}) {
    const Shot start = shot_of(box_on_floor(), kWalkSize);
    for (int step = 0; step < 3; ++step) of_walk(seen_from(start, step), {"temporal=on"}, threads);
    last.push_back(of_walk(seen_from(start, 3), {"temporal=on"}, threads));
  }
  EXPECT_TRUE(same_sums(last[0].frame, last[1].frame));
  EXPECT_TRUE(same_sums(last[0].frame, last[2].frame));
}

TEST(FragmentHistory, IsRefusedWhereThereIsNone) {
  const Shot shot = shot_of(box_on_floor(), {16, 16});
  const auto refused = [&](std::vector<std::string> settings, int spp) {
    settings.push_back("temporal=on");
    const View view(shot.camera, shot.size_px, PixelFilter(PixelFilter::Kind::centre));
    const Method& method = find_method("fragments");
    RenderJob job;
    job.world = shot.world, job.view = &view, job.settings = method.default_settings(), job.total_spp = static_cast<std::uint32_t>(spp);
    for (const std::string& setting : settings) job.settings.apply(setting);
    try {
      method.check(shot.world->scene(), job);
      return false;
    } catch (const Error& error) {
      return error.code() == ErrorCode::usage;
    }
  };
  EXPECT_FALSE(refused({}, 1));
  EXPECT_TRUE(refused({}, 4));
  EXPECT_TRUE(refused({"variant=nichols"}, 1));
  EXPECT_TRUE(refused({"variant=koa"}, 1));
  EXPECT_TRUE(refused({"refine=all"}, 1));
}

}  // namespace
}  // namespace sightline::test
