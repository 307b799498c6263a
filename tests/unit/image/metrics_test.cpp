#include "image/metrics/metrics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/core/error.h"
#include "image/tone_map.h"
#include "unit/image/test_pictures.h"

namespace sightline {
namespace {

double value(std::string_view name, const ColorImage& reference, const ColorImage& image, const MetricOptions& options = {}) {
  return find_metric(name).compute(reference, image, options);
}

ColorImage row(std::initializer_list<Color> pixels) {
  ColorImage image(static_cast<int>(pixels.size()), 1);
  image.pixels.assign(pixels);
  return image;
}

// Six values: R = 1 2 3 0 1 1, I = 2 2 1 1 1 1, so the squared errors are 1 0 4 1 0 0 and ΣR = 8, ΣR² = 16.
const ColorImage kReference = row({{1, 2, 3}, {0, 1, 1}}), kImage = row({{2, 2, 1}, {1, 1, 1}});

TEST(Metrics, HandComputedValues) {
  EXPECT_NEAR(value("mse", kReference, kImage), 1, 1e-12);
  EXPECT_NEAR(value("rmse", kReference, kImage), 1, 1e-12);
  EXPECT_NEAR(value("nmse", kReference, kImage), 6.0 / 8, 1e-12);
  EXPECT_NEAR(value("l2", kReference, kImage), 6.0 / 16, 1e-12);
  EXPECT_NEAR(value("linf", kReference, kImage), 4.0 / 8, 1e-12);
  EXPECT_NEAR(value("relmse", kReference, kImage), (1 / 1.01 + 4 / 9.01 + 1 / 0.01) / 6, 1e-12);
}

TEST(Metrics, PsnrIsTakenOnSrgbValuesAfterExposure) {
  const ColorImage dark = row({Color(0)}), light = row({Color(linear_from_srgb(0.1f))});
  EXPECT_NEAR(value("psnr", dark, light), 20, 1e-4);
  EXPECT_NEAR(value("psnr", dark, row({Color(linear_from_srgb(0.1f) / 4)}), {.exposure_ev = 2, .mask = {}}), 20, 1e-4);
}

TEST(Metrics, TheMaskLeavesPixelsOut) {
  const std::vector<std::uint8_t> mask = {0, 1};
  MetricOptions options;
  options.mask = mask;
  EXPECT_NEAR(value("mse", kReference, kImage, options), 1.0 / 3, 1e-12);
  EXPECT_NEAR(value("nmse", kReference, kImage, options), 1.0 / 2, 1e-12);
  // An error outside of the mask is invisible to every metric, also to those that filter.
  ColorImage reference = test::random_picture(40, 30, 6), image = reference;
  std::vector<std::uint8_t> half(reference.pixels.size(), 1);
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 15; ++x) {
      half[static_cast<std::size_t>(y * 40 + x)] = 0;
      image.at(x, y) += Color(3);
    }
  }
  options.mask = half;
  for (const Metric& metric : metrics()) {
    const double equal = metric.compute(reference, reference, options);
    EXPECT_EQ(metric.compute(reference, image, options), equal) << metric.name;
    EXPECT_NE(metric.compute(reference, image, {}), equal) << metric.name;
  }
}

TEST(Metrics, EqualPicturesHaveNoErrorEvenIfBlack) {
  for (const ColorImage& image : {test::random_picture(23, 19, 7), ColorImage(5, 4)}) {
    for (const Metric& metric : metrics()) {
      const double result = metric.compute(image, image, {});
      if (metric.name == "psnr")
        EXPECT_EQ(result, std::numeric_limits<double>::infinity());
      else
        EXPECT_NEAR(result, metric.name == "ssim" ? 1 : 0, 1e-6) << metric.name;
    }
  }
}

TEST(Metrics, SsimOfFlatPicturesIsItsLuminanceTerm) {
  const double r = 0.5, i = 0.25;
  const ColorImage reference(30, 20, Color(linear_from_srgb(0.5f))), image(30, 20, Color(linear_from_srgb(0.25f)));
  const double expected = (2 * r * i + 1e-4) / (r * r + i * i + 1e-4);
  EXPECT_NEAR(value("ssim", reference, image), expected, 1e-4);
}

TEST(Metrics, SsimAgreesWithItsDefinitionInThePictureCentre) {
  // One pixel counts, so the direct sums over its window are the whole metric... of the pixels that the mask lets in: all but a border.
  const ColorImage reference = test::random_picture(11, 11, 8), image = test::random_picture(11, 11, 9);
  const auto luma = [](const ColorImage& picture, std::size_t p) {
    return double{luminance(tone_map(picture.pixels[p], ToneMap::srgb, 0))};
  };
  double sum = 0;
  for (int cy = 0; cy < 11; ++cy) {
    for (int cx = 0; cx < 11; ++cx) {
      double w = 0, r = 0, i = 0, rr = 0, ii = 0, ri = 0;
      for (int y = std::max(0, cy - 5); y <= std::min(10, cy + 5); ++y) {
        for (int x = std::max(0, cx - 5); x <= std::min(10, cx + 5); ++x) {
          const double g = std::exp(-((x - cx) * (x - cx) + (y - cy) * (y - cy)) / (2 * 1.5 * 1.5));
          const auto p = static_cast<std::size_t>(y * 11 + x);
          const double a = luma(reference, p), b = luma(image, p);
          w += g, r += g * a, i += g * b, rr += g * a * a, ii += g * b * b, ri += g * a * b;
        }
      }
      r /= w, i /= w;
      const double vr = rr / w - r * r, vi = ii / w - i * i, cov = ri / w - r * i;
      sum += (2 * r * i + 1e-4) * (2 * cov + 9e-4) / ((r * r + i * i + 1e-4) * (vr + vi + 9e-4));
    }
  }
  EXPECT_NEAR(value("ssim", reference, image), sum / 121, 1e-4);
}

TEST(Metrics, WrongUseIsAUsageError) {
  const auto code = [](auto&& action) {
    try {
      action();
    } catch (const Error& error) {
      return error.code();
    }
    return ErrorCode::bug;
  };
  const std::vector<std::uint8_t> none(2, 0), wrong(3, 1);
  for (const Metric& metric : metrics()) {
    EXPECT_EQ(code([&] { metric.compute(kReference, ColorImage(3, 1), {}); }), ErrorCode::usage) << metric.name;
    EXPECT_EQ(code([&] { metric.compute(kReference, kImage, {.mask = none}); }), ErrorCode::usage) << metric.name;
    EXPECT_EQ(code([&] { metric.compute(kReference, kImage, {.mask = wrong}); }), ErrorCode::usage) << metric.name;
  }
  try {
    find_metric("filp");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("flip"), std::string::npos);
  }
}

}  // namespace
}  // namespace sightline
