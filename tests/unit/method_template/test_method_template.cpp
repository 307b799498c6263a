#include <gtest/gtest.h>

#include <cmath>

#include "methods/example/method.h"
#include "methods/reference/method.h"
#include "scene/load/load.h"

namespace sightline {
namespace {

constexpr IVec2 kSize{24, 24};
constexpr std::uint32_t kSamples = 256;

struct Picture {
  double mean = 0, standard_error = 0;
  PassStatistics statistics;
};

// Direct light of the Cornell box. The standard error comes from the spread of the means of 16 slices of the samples; of Sobol points it
// is an over-estimate.
Picture render_with(const Method& method, const std::string& setting = "") {
  Context context;
  context.threads = 2;
  Scene scene = load_scene("builtin:cornell", {}, context);
  const Camera camera = scene.cameras.at(0);
  const auto world = World::build(std::move(scene), {}, context);
  const View view(camera, kSize, PixelFilter());
  const VisibilityInfo& exact = find_visibility("exact");
  const std::unique_ptr<Visibility> visibility = exact.make(world, exact.settings, Context());
  RenderJob job;
  job.world = world;
  job.view = &view;
  job.settings = method.default_settings();
  if (!setting.empty()) job.settings.apply(setting);
  job.visibility = visibility.get();
  job.max_bounces = 0;
  job.total_spp = kSamples;
  const std::unique_ptr<const Bake> bake = method.prepare(job, context);
  job.bake = bake.get();
  Picture picture;
  double sum = 0, sum_of_squares = 0;
  constexpr std::uint32_t kSlices = 16;
  for (std::uint32_t slice = 0; slice < kSlices; ++slice) {
    const SampleRange range{slice * kSamples / kSlices, (slice + 1) * kSamples / kSlices};
    Frame frame(kSize.x, kSize.y, AovSet(), range.begin);
    method.render_pass(job, range, frame, picture.statistics, context);
    EXPECT_EQ(frame.samples_done(), range.count());
    const double mean = frame.mean_luminance();
    sum += mean;
    sum_of_squares += mean * mean;
  }
  picture.mean = sum / kSlices;
  picture.standard_error = std::sqrt(std::max(0.0, sum_of_squares / kSlices - picture.mean * picture.mean) / (kSlices - 1));
  return picture;
}

TEST(MethodTemplate, AgreesWithTheReferenceOnDirectLight) {
  const Picture truth = render_with(ReferenceMethod()), example = render_with(ExampleMethod());
  EXPECT_GT(truth.mean, 0.01);
  EXPECT_LT(example.standard_error, 0.01 * truth.mean);
  EXPECT_NEAR(example.mean, truth.mean, 4 * (truth.standard_error + example.standard_error));
}

TEST(MethodTemplate, SettingsReachTheKernel) {
  const double plain = render_with(ExampleMethod()).mean, doubled = render_with(ExampleMethod(), "brightness=2").mean;
  EXPECT_NEAR(doubled, 2 * plain, 1e-6 * plain);
}

TEST(MethodTemplate, CountsWhatItAsks) {
  const PassStatistics statistics = render_with(ExampleMethod()).statistics;
  EXPECT_GT(statistics.visibility.queries, 0u);
  EXPECT_EQ(statistics.visibility.queries, statistics.visibility.traced);
  EXPECT_GE(statistics.rays.closest, static_cast<std::uint64_t>(kSize.x) * kSize.y * kSamples);
}

}  // namespace
}  // namespace sightline
