// Answers that are kept over the frames of a camera move: fewer rays, and no more error than answers of the frame itself.
#include <gtest/gtest.h>

#include <cmath>

#include "session/render.h"
#include "support/studio.h"
#include "visibility/visibility.h"

namespace sightline::test {
namespace {

constexpr std::uint32_t kSpp = 4;

/// Frames of one visibility, as an animation would render them.
class Film {
 public:
  Film(std::shared_ptr<const World> world, const char* visibility, const std::vector<std::string>& settings) : world_(std::move(world)) {
    const ResolvedSettings resolved = resolve_settings(method_, find_visibility(visibility), settings);
    settings_ = resolved.method;
    visibility_ = find_visibility(visibility).make(world_, resolved.visibility, context_);
  }
  Picture next(const Camera& camera) {
    const IVec2 size{96, 72};
    const View view(camera, size, PixelFilter(PixelFilter::Kind::centre));
    Picture picture{Frame(size.x, size.y, {}), {}};
    RenderJob job;
    job.world = world_, job.view = &view, job.settings = settings_, job.visibility = visibility_.get();
    job.max_bounces = 3, job.total_spp = kSpp;
    method_.render_pass(job, {0, kSpp}, picture.frame, picture.statistics, context_);
    return picture;
  }

 private:
  const Method& method_ = find_method("bidirectional");
  std::shared_ptr<const World> world_;
  Context context_;
  SettingsValue settings_;
  std::unique_ptr<Visibility> visibility_;
};

double error(const Frame& picture, const Frame& truth) {
  double difference = 0, sum = 0;
  for (std::uint32_t pixel = 0; pixel < 96 * 72; ++pixel) {
    for (int c = 0; c < 3; ++c)
      difference += std::fabs(picture.color(pixel)[c] - truth.color(pixel)[c]), sum += static_cast<double>(truth.color(pixel)[c]);
  }
  return difference / sum;
}

TEST(ReuseOverFrames, SavesRaysAndAddsNoError) {
  const Shot shot = shot_of(builtin_scene("cornell"), {96, 72});
  Film exact(shot.world, "exact", {}), fresh(shot.world, "cached", {"ce=8"}), kept(shot.world, "cached", {"ce=8", "reuse=true"});
  Camera camera = shot.camera;
  for (int frame = 0; frame < 4; ++frame) {
    const Picture truth = exact.next(camera), alone = fresh.next(camera), reused = kept.next(camera);
    const auto rays = [](const Picture& p) { return p.statistics.visibility.traced; };
    const double own = error(alone.frame, truth.frame), with_others = error(reused.frame, truth.frame);
    // Passes of the first frame already share.
    EXPECT_LE(rays(reused), frame == 0 ? rays(alone) : rays(alone) * 3 / 4) << frame;
    EXPECT_FALSE(same_sums(reused.frame, alone.frame)) << frame;
    EXPECT_LT(with_others, 1.25 * own + 0.005) << frame;
    EXPECT_LT(with_others, 0.08) << frame;
    EXPECT_NEAR(reused.frame.mean_luminance() / truth.frame.mean_luminance(), 1, 0.01) << frame;
    camera.world_from_camera[3] += 0.01f * camera.world_from_camera[0];  // sideways
  }
}

}  // namespace
}  // namespace sightline::test
