// The visibility-cache method as a whole: the same bits however the work is split, few rays, little error, the reference's picture.
#include <gtest/gtest.h>

#include <cmath>

#include "base/core/error.h"
#include "session/render.h"
#include "support/studio.h"

namespace sightline::test {
namespace {

constexpr IVec2 kSize{100, 70};  // tiles that stick out

struct Order {
  std::string visibility = "cached";
  std::vector<std::string> settings{"vpls=32"};
  int spp = 4, threads = 2, max_bounces = 2;
  std::optional<SampleRange> range{};
  std::string method = "visibility-cache";
};

RenderResult take(const Shot& shot, const Order& run) {
  RenderRequest request;
  request.method = run.method;
  request.visibility = run.visibility;
  request.settings = run.settings;
  request.spp = run.spp;
  request.max_bounces = run.max_bounces;
  request.aovs = parse_aovs("all");
  request.sample_range = run.range;
  Context context;
  context.threads = run.threads;
  return render(shot.world, shot.camera, shot.size_px, PixelFilter(), request, context, Stopwatch());
}

// Σ |a - b| / Σ b over all pixels.
double linf(const Frame& a, const Frame& b) {
  double difference = 0, sum = 0;
  for (std::uint32_t p = 0; p < kSize.x * kSize.y; ++p) {
    const Color u = a.color(p), v = b.color(p);
    for (int c = 0; c < 3; ++c) difference += std::fabs(u[c] - v[c]), sum += v[c];
  }
  return difference / sum;
}

TEST(VisibilityCache, AnyNumberOfThreadsGivesTheSameBits) {
  for (const char* scene : {"glass", "cornell"}) {
    const Shot shot = shot_of(builtin_scene(scene), kSize);
    for (const char* visibility : {"exact", "cached", "shadow-map"}) {
      Order run{.visibility = visibility, .threads = 1};
      const RenderResult one = take(shot, run);
      for (const int threads : {2, 7}) {
        run.threads = threads;
        EXPECT_TRUE(same_sums(one.frame, take(shot, run).frame)) << scene << ", " << visibility << ", " << threads << " threads";
      }
    }
  }
}

TEST(VisibilityCache, RangesOfWholePassesAddUpToOneRun) {
  const Shot shot = shot_of(builtin_scene("glass"), kSize);
  Order run{.settings = {"vpls=16", "pass_spp=2"}, .spp = 5};
  const RenderResult whole = take(shot, run);
  run.range = SampleRange{0, 2};
  RenderResult parts = take(shot, run);
  for (const SampleRange range : {SampleRange{2, 4}, SampleRange{4, 5}}) {
    run.range = range;
    parts.frame.merge(take(shot, run).frame);
  }
  EXPECT_TRUE(same_sums(whole.frame, parts.frame));
  // A cut through samples that share answers could not give the same picture.
  run.range = SampleRange{0, 3};
  EXPECT_THROW(take(shot, run), Error);
}

TEST(VisibilityCache, OfItsOrderOnlyTheCacheNotTheContributionsDepend) {
  const Shot shot = shot_of(builtin_scene("spheres"), kSize);
  const RenderResult exact = take(shot, {.visibility = "exact"});
  const RenderResult cached = take(shot, {.settings = {"vpls=32", "ce=8"}});
  EXPECT_EQ(exact.statistics.visibility.queries, cached.statistics.visibility.queries);
  EXPECT_LT(cached.statistics.visibility.traced, exact.statistics.visibility.traced / 4);
  EXPECT_LT(linf(cached.frame, exact.frame), 0.05);
  EXPECT_GT(linf(cached.frame, exact.frame), 0);
  // Finer cells: more rays, less error.
  const RenderResult finer = take(shot, {.settings = {"vpls=32", "ce=2"}});
  EXPECT_GT(finer.statistics.visibility.traced, cached.statistics.visibility.traced);
  EXPECT_LT(linf(finer.frame, exact.frame), linf(cached.frame, exact.frame));
  // Scanline order asks the same questions.
  const RenderResult scanline = take(shot, {.settings = {"vpls=32", "ce=8", "order=scanline"}});
  EXPECT_EQ(scanline.statistics.visibility.queries, exact.statistics.visibility.queries);
  EXPECT_FALSE(same_sums(scanline.frame, cached.frame));
}

TEST(VisibilityCache, DirectLightIsTheReferencesInTheMean) {
  for (const char* scene : {"cornell", "spheres", "two-quads"}) {
    const Shot shot = shot_of(builtin_scene(scene), kSize);
    // Without bounces the reference does not look into mirrors.
    const RenderResult own = take(shot, {.visibility = "exact", .settings = {"specular_depth=0"}, .spp = 16, .max_bounces = 0});
    const RenderResult reference = take(shot, {.visibility = "exact", .settings = {}, .spp = 256, .max_bounces = 0, .method = "reference"});
    EXPECT_NEAR(own.frame.mean_luminance() / reference.frame.mean_luminance(), 1, 0.01) << scene;
  }
}

TEST(VisibilityCache, OneBounceOfVirtualLightsIsTheReferencesInTheMean) {
  const Shot shot = shot_of(builtin_scene("cornell"), kSize);
  const RenderResult own =
      take(shot, {.visibility = "exact", .settings = {"vpls=256", "vpl_clamp=0", "pass_spp=1"}, .spp = 16, .max_bounces = 1});
  const RenderResult reference = take(shot, {.visibility = "exact", .settings = {}, .spp = 256, .max_bounces = 1, .method = "reference"});
  EXPECT_NEAR(own.frame.mean_luminance() / reference.frame.mean_luminance(), 1, 0.015);
}

}  // namespace
}  // namespace sightline::test
