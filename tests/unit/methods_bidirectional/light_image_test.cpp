// The film's light image: it belongs to all samples together, and survives files, merging and interruption.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "film/frame.h"
#include "film/frame_file.h"
#include "methods/method.h"
#include "support/studio.h"

namespace sightline::test {
namespace {

TEST(LightImage, IsDividedByTheMeanNumberOfSamples) {
  Frame frame(64, 32, parse_aovs("direct,indirect"));
  frame.enable_light_image();
  frame.add_color(0, 0, Color(1));
  frame.splat(0, 0, Color(3), true);
  frame.splat(40, 0, Color(0.5f), false);
  frame.set_samples_done(0, 1);
  frame.set_samples_done(1, 3);
  // Two samples a pixel, on the mean.
  EXPECT_EQ(frame.color(0), Color(1 + 1.5f));
  EXPECT_EQ(frame.value(Aov::direct, 0), Vec3(1.5f));
  EXPECT_EQ(frame.color(40), Color(0.25f));
  EXPECT_EQ(frame.value(Aov::indirect, 40), Vec3(0.25f));
  EXPECT_EQ(frame.color_image().pixels[0], frame.color(0));
  EXPECT_NEAR(frame.mean_luminance(), (2.5 + 0.25) / (64 * 32), 1e-9);
}

TEST(LightImage, NonFiniteArrivalsAreDroppedAndCounted) {
  Frame frame(8, 8, {});
  frame.enable_light_image();
  frame.splat(3, 5, Color(std::numeric_limits<float>::quiet_NaN()), false);
  frame.set_samples_done(0, 1);
  EXPECT_EQ(frame.nonfinite_samples(), 1u);
  EXPECT_EQ(frame.color(3), Color(0));
  EXPECT_EQ(frame.first_bad_sample()->sample, 5u);
}

TEST(LightImage, SurvivesFilesAndAddsUp) {
  Frame frame(40, 20, parse_aovs("direct,variance"));
  frame.enable_light_image();
  for (std::uint32_t pixel = 0; pixel < 800; ++pixel) frame.splat(pixel, 0, Color(1.f / static_cast<float>(pixel + 1)), pixel % 2 == 0);
  frame.set_samples_done(0, 2), frame.set_samples_done(1, 2);
  StoredFrame stored = decode_frame(encode_frame(frame, {"me"}, {}), "memory");
  EXPECT_TRUE(same_sums(frame, stored.frame));
  EXPECT_EQ(stored.frame.color(7), frame.color(7));
  // The frame without a light image takes the other's.
  Frame sum(40, 20, parse_aovs("direct,variance"));
  sum.merge(frame), sum.merge(stored.frame);
  EXPECT_EQ(sum.color(7), frame.color(7));
  EXPECT_EQ(sum.value(Aov::direct, 8), frame.value(Aov::direct, 8));
  EXPECT_FALSE(same_sums(sum, frame));
}

TEST(LightImage, ErrorEstimateIsThatOfRareArrivals) {
  // Poisson: k arrivals of 1 in n samples have the relative error 1 / sqrt(k).
  Frame frame(1, 1, parse_aovs("variance"));
  frame.enable_light_image();
  for (int i = 0; i < 100; ++i) frame.splat(0, 0, Color(1), false);
  for (std::uint32_t i = 0; i < 1000; ++i) frame.add_color(0, i, Color(0));
  frame.set_samples_done(0, 1000);
  EXPECT_NEAR(*frame.estimated_error(), 0.1, 1e-3);
}

}  // namespace
}  // namespace sightline::test
