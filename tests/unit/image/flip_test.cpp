#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "image/io/image_io.h"
#include "image/metrics/metrics.h"
#include "image/tone_map.h"
#include "unit/image/test_pictures.h"

namespace sightline {
namespace {

/// FLIP of two flat greys, by hand: no features, no hue, only L*. The largest colour difference comes from the CIELAB values of Rec.709's
/// green (87.735, −86.183, 83.179) and blue (32.297, 79.188, −107.860).
double flip_of_greys(double reference, double image) {
  const auto lightness = [](double y) { return 116 * std::cbrt(y) - 16; };
  const double a = 0.87735 * -86.183 - 0.32297 * 79.188, b = 0.87735 * 83.179 - 0.32297 * -107.860;
  const double largest = std::pow(87.735 - 32.297 + std::hypot(a, b), 0.7), limit = 0.4 * largest;
  const double error = std::pow(std::fabs(lightness(reference) - lightness(image)), 0.7);
  return error < limit ? 0.95 / limit * error : 0.95 + 0.05 * (error - limit) / (largest - limit);
}

TEST(Flip, FlatGreysHaveTheValueOfTheFormula) {
  for (const auto& [r, i] : {std::pair{0.5f, 0.4f}, {0.2f, 0.9f}, {1.0f, 0.02f}}) {
    const double flip = find_metric("flip").compute(ColorImage(24, 18, Color(r)), ColorImage(24, 18, Color(i)), {});
    EXPECT_NEAR(flip, flip_of_greys(r, i), 2e-4) << r << " " << i;
  }
}

TEST(Flip, IsBoundedSymmetricAndSeesExposure) {
  const ColorImage a = test::random_picture(64, 48, 21), b = test::random_picture(64, 48, 22);
  const std::vector<float> map = flip_map(a, b, {}), mirrored = flip_map(b, a, {});
  for (std::size_t i = 0; i < map.size(); ++i) {
    EXPECT_GE(map[i], 0);
    EXPECT_LE(map[i], 1);
    EXPECT_NEAR(map[i], mirrored[i], 1e-5f);
  }
  const ColorImage grey(16, 16, Color(0.125f)), other(16, 16, Color(0.1f));
  EXPECT_NEAR(find_metric("flip").compute(grey, other, {.exposure_ev = 2, .mask = {}}), flip_of_greys(0.5, 0.4), 2e-4);
}

TEST(Flip, AnErrorFadesWithDistanceAndIsFoundWhereItIs) {
  const ColorImage reference(64, 64, Color(0.3f));
  ColorImage image = reference;
  image.at(40, 20) = Color(1, 0, 0);
  const std::vector<float> map = flip_map(reference, image, {});
  const auto largest = static_cast<int>(std::max_element(map.begin(), map.end()) - map.begin());
  EXPECT_LE(std::abs(largest % 64 - 40), 1);
  EXPECT_LE(std::abs(largest / 64 - 20), 1);
  EXPECT_NEAR(map[0], 0, 1e-4f);
}

TEST(Flip, HdrFlipFindsErrorsInTheDarkAndInTheBright) {
  // A bright part at 100, and a larger one, so that the median is there, at 0.01: the display clips one or hides the other, the series of
  // exposures shows both.
  ColorImage reference(32, 32, Color(0.01f));
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 32; ++x) reference.at(x, y) = Color(100);
  }
  ColorImage bright = reference, dark = reference;
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 32; ++x) bright.at(x, y) *= 0.7f;
  }
  for (int y = 12; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) dark.at(x, y) *= 0.7f;
  }
  EXPECT_LT(find_metric("flip").compute(reference, bright, {}), 1e-3);
  EXPECT_GT(find_metric("hdrflip").compute(reference, bright, {}), 0.05);
  EXPECT_GT(find_metric("hdrflip").compute(reference, dark, {}), 0.05);
  const std::vector<float> map = hdrflip_map(reference, bright, {});
  for (const float value : map) EXPECT_TRUE(value >= 0 && value <= 1);
}

TEST(Flip, HdrFlipDoesNotChangeWithTheScaleOfLight) {
  ColorImage a = test::random_picture(32, 24, 31), b = a;
  for (std::size_t i = 0; i < b.pixels.size(); ++i) b.pixels[i] *= i % 3 == 0 ? 1.2f : 0.9f;
  const double before = find_metric("hdrflip").compute(a, b, {});
  for (ColorImage* image : {&a, &b}) {
    for (Color& pixel : image->pixels) pixel *= 64.0f;
  }
  EXPECT_NEAR(find_metric("hdrflip").compute(a, b, {}), before, 1e-3);
}

TEST(Flip, KnownPairsHaveTheirPublishedValues) {
  const auto data = test::shared_data();
  if (!data || !std::filesystem::exists(*data / "flip")) return;
  const std::vector<std::pair<std::string, double>> pairs = {
      {"direct", 0.010884817}, {"dragon", 0.16117312}, {"hairball", 0.105360515}, {"sponza", 0.27256736}};
  for (const auto& [name, expected] : pairs) {
    // The stored numbers are display values, so they are decoded to the linear light that our metric takes.
    const auto read = [&](const char* ending) {
      ColorImage image = color_of(read_layered_image(*data / "flip" / (name + ending)));
      for (Color& pixel : image.pixels) {
        for (int c = 0; c < 3; ++c) pixel[c] = linear_from_srgb(std::clamp(pixel[c], 0.0f, 1.0f));
      }
      return image;
    };
    MetricOptions options;
    options.pixels_per_degree = 67.0206f;
    EXPECT_NEAR(find_metric("flip").compute(read("_a.exr"), read("_b.exr"), options), expected, 1e-5) << name;
  }
}

}  // namespace
}  // namespace sightline
