// The same bits whatever the number of threads, passes, ranges and interruptions.
#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <set>
#include <thread>

#include "image/io/image_io.h"
#include "session/render.h"
#include "support/studio.h"

namespace sightline::test {
namespace {

const char* const kScenes[] = {"cornell", "glass", "textured", "hairball,triangles=3000", "spheres"};
constexpr IVec2 kSize{150, 100};

/// Threads that finished a tile. Until all have been seen each report takes a while, so that the others come to work before the tiles are
/// used up, however busy the machine.
class ThreadCensus {
 public:
  explicit ThreadCensus(Context& context) : expected_(static_cast<std::size_t>(context.threads)) {
    context.progress = [this](const Progress& progress) {
      if (progress.phase != "render") return;
      const std::lock_guard lock(mutex_);
      ids_.insert(std::this_thread::get_id());
      if (ids_.size() < expected_) std::this_thread::sleep_for(std::chrono::milliseconds(25));
    };
  }
  std::size_t count() const { return ids_.size(); }

 private:
  std::size_t expected_;
  std::mutex mutex_;
  std::set<std::thread::id> ids_;
};

Exposure exposure() { return {.spp = 6, .max_bounces = 4, .seed = 11, .filter = PixelFilter::Kind::gaussian, .aovs = parse_aovs("all")}; }

Picture expose_in(const Shot& shot, const std::vector<SampleRange>& ranges, std::uint32_t first = 0, int spp = 6) {
  Exposure e = exposure();
  e.spp = spp;
  Context context;
  context.seed = e.seed;
  context.threads = 2;
  Picture picture{empty_frame(shot, e, first), {}};
  for (const SampleRange& range : ranges) expose_range(shot, e, range, picture, context);
  return picture;
}

std::vector<std::byte> exr_bytes(const Frame& frame) { return encode_exr(frame.to_layered_image()); }

TEST(SamePicture, AnyNumberOfThreadsGivesTheSameBytes) {
  for (const char* name : kScenes) {
    const Shot shot = shot_of(builtin_scene(name), kSize);
    std::optional<Picture> single;
    for (const int threads : {1, 2, 7}) {
      // A busy machine may keep a thread away until all is done: then once more.
      Picture picture{empty_frame(shot, exposure()), {}};
      std::size_t seen = 0;
      for (int attempt = 0; attempt < 20 && seen != static_cast<std::size_t>(threads); ++attempt) {
        Context context;
        context.seed = 11;
        context.threads = threads;
        ThreadCensus census(context);
        picture = {empty_frame(shot, exposure()), {}};
        ASSERT_GE(picture.frame.tile_count(), 20u);
        expose_range(shot, exposure(), {0, 6}, picture, context);
        seen = census.count();
      }
      EXPECT_EQ(seen, static_cast<std::size_t>(threads)) << name;
      if (!single) {
        single = std::move(picture);
        continue;
      }
      EXPECT_TRUE(same_sums(single->frame, picture.frame)) << name << ", " << threads << " threads";
      EXPECT_EQ(exr_bytes(single->frame), exr_bytes(picture.frame)) << name << ", " << threads << " threads";
      EXPECT_EQ(single->statistics.rays.closest, picture.statistics.rays.closest);
      EXPECT_EQ(single->statistics.rays.occlusion, picture.statistics.rays.occlusion);
    }
  }
}

TEST(SamePicture, RangesOfSamplesMergeIntoOneRun) {
  for (const char* name : kScenes) {
    const Shot shot = shot_of(builtin_scene(name), kSize);
    const Picture whole = expose_in(shot, {{0, 10}}, 0, 10);
    Picture first = expose_in(shot, {{0, 3}}, 0, 10);
    const Picture second = expose_in(shot, {{3, 10}}, 3, 10);
    EXPECT_FALSE(same_sums(whole.frame, first.frame));
    first.frame.merge(second.frame);
    EXPECT_TRUE(same_sums(whole.frame, first.frame)) << name;
  }
}

TEST(SamePicture, PassesAddUpToOne) {
  for (const char* name : kScenes) {
    const Shot shot = shot_of(builtin_scene(name), kSize);
    const Picture whole = expose_in(shot, {{0, 6}});
    EXPECT_TRUE(same_sums(whole.frame, expose_in(shot, {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 6}}).frame)) << name;
    EXPECT_TRUE(same_sums(whole.frame, expose_in(shot, {{0, 4}, {4, 6}}).frame)) << name;
    // A pass over samples that are there already adds nothing.
    EXPECT_TRUE(same_sums(whole.frame, expose_in(shot, {{0, 6}, {0, 6}, {2, 5}}).frame)) << name;
  }
}

TEST(SamePicture, LightSamplesOfPassesAddUpToOne) {
  const Shot shot = shot_of(builtin_scene("cornell"), {64, 64});
  const auto one_hit = [&](const std::vector<SampleRange>& ranges) {
    Exposure e{.settings = {"mode=one-hit"}, .spp = 4, .light_samples = 7, .max_bounces = 0};
    Picture picture{empty_frame(shot, e), {}};
    for (const SampleRange& range : ranges) expose_range(shot, e, range, picture, Context());
    return picture;
  };
  EXPECT_TRUE(same_sums(one_hit({{0, 4}}).frame, one_hit({{0, 1}, {1, 4}}).frame));
}

/// Interrupts after a number of finished tiles: in the middle of a pass.
class Interruption {
 public:
  Interruption(Context& context, int tiles) : tiles_(tiles) {
    context.progress = [this, &context](const Progress& progress) {
      if (progress.phase == "render" && --tiles_ == 0) context.cancelled = true;
    };
  }

 private:
  std::atomic<int> tiles_;
};

TEST(SamePicture, ResumedRenderEqualsAnUninterruptedOne) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir());
  for (const char* name : kScenes) {
    const Shot shot = shot_of(builtin_scene(name), kSize);
    RenderRequest request;
    request.spp = 9;
    request.max_bounces = 3;
    request.aovs = parse_aovs("albedo,variance");
    Context plain;
    plain.threads = 2;
    const RenderResult whole = render(shot.world, shot.camera, shot.size_px, PixelFilter(), request, plain, Stopwatch());
    ASSERT_EQ(whole.stop, StopReason::samples);
    const std::filesystem::path checkpoint = folder / "sightline_resume_test.checkpoint";
    for (const int tiles : {5, 50}) {
      std::filesystem::remove(checkpoint);
      RenderRequest first = request;
      first.checkpoint = checkpoint;
      Context interrupted;
      interrupted.threads = 2;
      const Interruption interruption(interrupted, tiles);
      const RenderResult part = render(shot.world, shot.camera, shot.size_px, PixelFilter(), first, interrupted, Stopwatch());
      ASSERT_EQ(part.stop, StopReason::interrupted) << name;
      EXPECT_LT(part.frame.samples_done(), 9u);
      RenderRequest second = request;
      second.resume = checkpoint;
      const RenderResult resumed = render(shot.world, shot.camera, shot.size_px, PixelFilter(), second, plain, Stopwatch());
      EXPECT_EQ(resumed.stop, StopReason::samples);
      EXPECT_TRUE(same_sums(whole.frame, resumed.frame)) << name << " after " << tiles << " tiles";
    }
    std::filesystem::remove(checkpoint);
  }
}

}  // namespace
}  // namespace sightline::test
