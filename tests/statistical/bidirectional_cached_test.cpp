// Bidirectional path tracing with connections from a visibility cache: the same bits however the work is split, few rays, little error.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <filesystem>

#include "base/core/error.h"
#include "session/render.h"
#include "support/studio.h"

namespace sightline::test {
namespace {

constexpr IVec2 kSize{96, 64};

struct Order {
  std::string visibility = "cached";
  std::vector<std::string> settings{};
  int spp = 4, threads = 2;
  std::optional<SampleRange> range{};
  std::optional<std::filesystem::path> checkpoint{}, resume{};
  int stop_after_tiles = 0;
};

RenderResult take(const Shot& shot, const Order& run) {
  RenderRequest request;
  request.method = "bidirectional";
  request.visibility = run.visibility;
  request.settings = run.settings;
  request.spp = run.spp;
  request.max_bounces = 4;
  request.aovs = parse_aovs("all");
  request.sample_range = run.range;
  request.checkpoint = run.checkpoint;
  request.resume = run.resume;
  Context context;
  context.threads = run.threads;
  std::atomic<int> tiles{run.stop_after_tiles};
  if (run.stop_after_tiles > 0) {
    context.progress = [&](const Progress& progress) {
      if (progress.phase == "render" && --tiles == 0) context.cancelled = true;
    };
  }
  return render(shot.world, shot.camera, shot.size_px, PixelFilter(), request, context, Stopwatch());
}

const std::vector<Order> kKinds = {
    {.visibility = "exact"}, {.visibility = "cached"}, {.visibility = "cached", .settings = {"pass_spp=2", "density=conditional"}}};

TEST(BidirectionalCached, AnyNumberOfThreadsGivesTheSameBits) {
  for (const char* scene : {"glass", "spheres"}) {
    const Shot shot = shot_of(builtin_scene(scene), kSize);
    for (Order run : kKinds) {
      run.threads = 1;
      const RenderResult one = take(shot, run);
      for (const int threads : {2, 7}) {
        run.threads = threads;
        const RenderResult other = take(shot, run);
        EXPECT_TRUE(same_sums(one.frame, other.frame)) << scene << ", " << run.visibility << ", " << threads << " threads";
        EXPECT_EQ(one.statistics.visibility.traced, other.statistics.visibility.traced);
      }
    }
  }
}

TEST(BidirectionalCached, RangesOfSamplesMergeIntoOneRun) {
  const Shot shot = shot_of(builtin_scene("glass"), kSize);
  for (Order run : kKinds) {
    const RenderResult whole = take(shot, run);
    run.range = SampleRange{0, 2};
    RenderResult first = take(shot, run);
    run.range = SampleRange{2, 4};
    const RenderResult second = take(shot, run);
    EXPECT_FALSE(same_sums(whole.frame, first.frame));
    first.frame.merge(second.frame);
    EXPECT_TRUE(same_sums(whole.frame, first.frame)) << run.visibility;
    for (const std::uint32_t pixel : {0u, 777u, 5999u}) EXPECT_EQ(whole.frame.color(pixel), first.frame.color(pixel));
  }
}

TEST(BidirectionalCached, ResumedRenderEqualsAnUninterruptedOne) {
  const std::filesystem::path checkpoint = std::filesystem::path(testing::TempDir()) / "sightline_bidirectional_test.checkpoint";
  // Wide enough for two waves a pass.
  const Shot shot = shot_of(builtin_scene("glass"), {200, 170});
  for (Order run : kKinds) {
    const RenderResult whole = take(shot, run);
    for (const int tiles : {5, 60}) {
      std::filesystem::remove(checkpoint);
      Order first = run;
      first.stop_after_tiles = tiles;
      first.checkpoint = checkpoint;
      const RenderResult part = take(shot, first);
      ASSERT_EQ(part.stop, StopReason::interrupted);
      Order second = run;
      second.resume = checkpoint;
      EXPECT_TRUE(same_sums(whole.frame, take(shot, second).frame)) << run.visibility << " after " << tiles << " tiles";
    }
    std::filesystem::remove(checkpoint);
  }
}

TEST(BidirectionalCached, ConnectionsNeedFewRaysAndThePictureStaysTheSame) {
  const Shot shot = shot_of(builtin_scene("cornell"), {128, 128});
  const RenderResult exact = take(shot, {.visibility = "exact", .spp = 16});
  const RenderResult cached = take(shot, {.visibility = "cached", .settings = {"ce=12"}, .spp = 16});
  const auto number = [](const RenderResult& r, const char* name) { return r.statistics.method_statistics.at(name); };
  const double queries = number(cached, "light_sample_queries") + number(cached, "connection_queries");
  const double traced = static_cast<double>(cached.statistics.visibility.traced) - number(cached, "light_image_rays");
  EXPECT_EQ(queries, number(exact, "light_sample_queries") + number(exact, "connection_queries"));
  EXPECT_GT(queries, 5 * traced);
  double difference = 0, sum = 0, signed_difference = 0;
  for (std::uint32_t pixel = 0; pixel < 128 * 128; ++pixel) {
    const Vec3 a = exact.frame.color(pixel), b = cached.frame.color(pixel);
    for (int c = 0; c < 3; ++c) {
      difference += std::fabs(static_cast<double>(a[c]) - static_cast<double>(b[c]));
      signed_difference += static_cast<double>(b[c]) - static_cast<double>(a[c]);
      sum += static_cast<double>(a[c]);
    }
  }
  EXPECT_LT(difference, 0.05 * sum);
  EXPECT_LT(std::fabs(signed_difference), 0.005 * sum);
}

TEST(BidirectionalCached, ClosedDiffuseBoxKeepsItsLight) {
  const Shot shot = shot_of(builtin_scene("furnace,shape=box"), {64, 64});
  const RenderResult exact = take(shot, {.visibility = "exact", .spp = 8});
  const RenderResult cached = take(shot, {.visibility = "cached", .settings = {"ce=12"}, .spp = 8});
  EXPECT_NEAR(cached.frame.mean_luminance() / exact.frame.mean_luminance(), 1, 0.01);
}

}  // namespace
}  // namespace sightline::test
