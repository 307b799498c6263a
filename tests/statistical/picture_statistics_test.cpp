// The detectors themselves: they must notice a wrong picture, and stay quiet about a right one.
#include "support/picture_statistics.h"

#include <gtest/gtest.h>

namespace sightline::test {
namespace {

TEST(PictureStatistics, StudentTailHasItsTabulatedValues) {
  EXPECT_NEAR(student_tail(1, 1), 0.5, 1e-6);
  EXPECT_NEAR(student_tail(2.228, 10), 0.05, 1e-4);
  EXPECT_NEAR(student_tail(4.587, 10), 0.001, 1e-5);
  EXPECT_NEAR(student_tail(1.96, 1e5), 0.05, 1e-4);
}

TEST(PictureStatistics, OnePercentMoreLightIsNoticed) {
  const Exposure exposure{.spp = 32, .max_bounces = 2};
  const Replicates right = replicate(shot_of(builtin_scene("cornell"), {12, 12}), exposure, 16);
  Exposure other = exposure;
  other.seed = 9;
  const Replicates brighter = replicate(shot_of(builtin_scene("cornell,radiance=16.16"), {12, 12}), other, 16);
  EXPECT_LT(compare(right, brighter).mean_p, 1e-3);
  const Replicates same = replicate(shot_of(builtin_scene("cornell"), {12, 12}), other, 16);
  EXPECT_GT(compare(right, same).mean_p, 1e-2);
  EXPECT_GT(compare(right, same).pixel_p, 1e-2);
}

TEST(PictureStatistics, OneWrongPixelIsNoticed) {
  const Replicates right = replicate(shot_of(builtin_scene("cornell"), {12, 12}), {.spp = 32, .max_bounces = 2}, 16);
  Replicates wrong = replicate(shot_of(builtin_scene("cornell"), {12, 12}), {.spp = 32, .max_bounces = 2, .seed = 9}, 16);
  wrong.mean[70] *= 1.5;
  EXPECT_LT(compare(right, wrong).pixel_p, 1e-3);
}

}  // namespace
}  // namespace sightline::test
