#include "bench/visibility_cache/figures.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bench/median.h"

namespace sightline {
namespace {

TEST(CacheFigures, MedianIsTheMiddleValueWhateverTheOrder) {
  EXPECT_EQ(median({5, 1, 3}), 3);
  EXPECT_EQ(median({2}), 2);
  EXPECT_EQ(median({4, 1, 3, 2}), 3);
  EXPECT_EQ(median({}), 0);
}

// The abstract of the paper: a reduction of 50 times leaves 1 / 51 of the rays.
TEST(CacheFigures, RayReductionIsHitsOverMisses) {
  VisibilityCounts counts;
  counts.queries = 5100, counts.traced = 100, counts.lookups = 10200, counts.rejected = 51;
  const QueryFigures figures = query_figures(counts);
  EXPECT_DOUBLE_EQ(figures.ray_reduction, 50);
  EXPECT_DOUBLE_EQ(figures.share_traced, 1 / 51.0);
  EXPECT_DOUBLE_EQ(figures.lookups_per_query, 2);
  EXPECT_DOUBLE_EQ(figures.rejected_share, 0.005);
}

TEST(CacheFigures, PicturesWithoutQueriesOrRaysHaveFigures) {
  VisibilityCounts counts;
  EXPECT_EQ(query_figures(counts).share_traced, 0);
  EXPECT_EQ(query_figures(counts).ray_reduction, 0);
  counts.queries = 10;
  EXPECT_TRUE(std::isinf(query_figures(counts).ray_reduction));
  // Corrections can be more rays than queries.
  counts.traced = 12;
  EXPECT_EQ(query_figures(counts).ray_reduction, 0);
  EXPECT_DOUBLE_EQ(query_figures(counts).share_traced, 1.2);
}

TEST(CacheFigures, SignedErrorIsRelativeToWhatTheMaskLeaves) {
  const ColorImage reference(2, 1, Color(1));
  ColorImage image = reference;
  image.at(0, 0) = Color(1.5f), image.at(1, 0) = Color(0.25f);
  EXPECT_DOUBLE_EQ(signed_error(reference, image, {}), -0.125);
  const std::vector<std::uint8_t> left = {1, 0};
  EXPECT_DOUBLE_EQ(signed_error(reference, image, left), 0.5);
}

TEST(CacheFigures, SamplesFitIntoTheBudgetInProportion) {
  EXPECT_EQ(samples_in_time(16, 4, 1), 4);
  EXPECT_EQ(samples_in_time(16, 1, 2), 32);
  EXPECT_EQ(samples_in_time(16, 100, 1), 1);
  EXPECT_EQ(samples_in_time(16, 0, 1), 1);
}

TEST(CacheFigures, AnErrorThatStaysDoesNotFlicker) {
  Flicker flicker;
  for (int frame = 0; frame < 4; ++frame) {
    const ColorImage exact(3, 2, Color(1.f + static_cast<float>(frame)));
    ColorImage image = exact;
    image.at(1, 1) += Color(0.5f);
    flicker.add(exact, image);
  }
  EXPECT_EQ(flicker.value(), 0);
}

TEST(CacheFigures, AnErrorThatComesAndGoesFlickersByItsSize) {
  Flicker flicker;
  const ColorImage exact(2, 2, Color(1));
  ColorImage image = exact;
  image.at(0, 1) = Color(0.5f);
  flicker.add(exact, image);
  EXPECT_EQ(flicker.value(), 0);
  flicker.add(exact, exact);
  EXPECT_DOUBLE_EQ(flicker.value(), 0.125);
  flicker.add(exact, image);
  flicker.add(exact, image);
  // 0.5 + 0.5 + 0 over three frames of 4.
  EXPECT_DOUBLE_EQ(flicker.value(), 1.0 / 12);
}

}  // namespace
}  // namespace sightline
