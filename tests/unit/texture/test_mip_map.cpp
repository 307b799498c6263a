#include "texture/mip_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "image/tone_map.h"

namespace sightline {
namespace {

using Wraps = MipMap::Wraps;

std::shared_ptr<const Image> float_image(int width, int height, int channels, std::vector<float> values) {
  return std::make_shared<const Image>(Image{width, height, channels, std::move(values)});
}
std::shared_ptr<const Image> byte_image(int width, int height, int channels, std::vector<std::uint8_t> values) {
  return std::make_shared<const Image>(Image{width, height, channels, std::move(values)});
}
std::shared_ptr<const Image> random_bytes(int width, int height, int channels) {
  std::mt19937 random(7);
  std::vector<std::uint8_t> values(static_cast<std::size_t>(width * height * channels));
  for (auto& v : values) v = static_cast<std::uint8_t>(random() & 255u);
  return byte_image(width, height, channels, std::move(values));
}

const Wraps kRepeat{Wrap::repeat, Wrap::repeat};

TEST(MipMap, TexelCentresGiveStoredValuesAndRowZeroIsTheTop) {
  const MipMap map(float_image(3, 2, 1, {0, 1, 2, 10, 11, 12}), ColorEncoding::linear, true);
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 3; ++x) {
      const Vec2 uv{(static_cast<float>(x) + 0.5f) / 3, (static_cast<float>(y) + 0.5f) / 2};
      EXPECT_NEAR(map.bilinear(0, uv, kRepeat).x, static_cast<float>(10 * y + x), 1e-5f);
      EXPECT_EQ(map.nearest(uv, kRepeat).x, static_cast<float>(10 * y + x));
    }
  }
}

TEST(MipMap, BilinearInterpolatesByHand) {
  const MipMap map(float_image(2, 2, 1, {0, 4, 8, 20}), ColorEncoding::linear, true);
  // A quarter of a texel right of and above the middle: weights 1/4 3/4 across, 3/4 1/4 down.
  const Vec2 uv{0.5f + 0.25f / 2, 0.5f - 0.25f / 2};
  EXPECT_NEAR(map.bilinear(0, uv, kRepeat).x, 0.75f * (0.25f * 0 + 0.75f * 4) + 0.25f * (0.25f * 8 + 0.75f * 20), 1e-5f);
}

TEST(MipMap, WrapModesReadTheRightTexels) {
  const MipMap map(float_image(4, 1, 1, {1, 2, 3, 4}), ColorEncoding::linear, true);
  const auto at = [&](int texel, Wrap wrap) { return map.nearest({(static_cast<float>(texel) + 0.5f) / 4, 0.5f}, {wrap, Wrap::clamp}).x; };
  EXPECT_EQ(at(-1, Wrap::repeat), 4);
  EXPECT_EQ(at(4, Wrap::repeat), 1);
  EXPECT_EQ(at(-9, Wrap::repeat), 4);
  EXPECT_EQ(at(-1, Wrap::clamp), 1);
  EXPECT_EQ(at(40, Wrap::clamp), 4);
  EXPECT_EQ(at(-1, Wrap::mirror), 1);
  EXPECT_EQ(at(-2, Wrap::mirror), 2);
  EXPECT_EQ(at(4, Wrap::mirror), 4);
  EXPECT_EQ(at(7, Wrap::mirror), 1);
  EXPECT_EQ(at(8, Wrap::mirror), 1);
  EXPECT_EQ(at(-1, Wrap::black), 0);
  EXPECT_EQ(at(4, Wrap::black), 0);
  EXPECT_EQ(at(3, Wrap::black), 4);
  // Bilinear look-ups across the border mix with what the mode says lies beyond.
  const auto edge = [&](float u, Wrap wrap) { return map.bilinear(0, {u, 0.5f}, {wrap, Wrap::clamp}).x; };
  EXPECT_NEAR(edge(0, Wrap::repeat), 2.5f, 1e-5f);
  EXPECT_NEAR(edge(0, Wrap::clamp), 1, 1e-5f);
  EXPECT_NEAR(edge(0, Wrap::mirror), 1, 1e-5f);
  EXPECT_NEAR(edge(0, Wrap::black), 0.5f, 1e-5f);
  EXPECT_NEAR(edge(1, Wrap::repeat), 2.5f, 1e-5f);
  EXPECT_NEAR(edge(1, Wrap::mirror), 4, 1e-5f);
}

TEST(MipMap, EveryLevelKeepsTheMeanAlsoForOddSizes) {
  for (const auto& [width, height] : {std::pair{64, 64}, {37, 19}, {1, 23}, {5, 1}}) {
    std::mt19937 random(3);
    std::vector<float> values(static_cast<std::size_t>(width * height * 3));
    double sum = 0;
    for (float& v : values) sum += (v = static_cast<float>(random() % 1000u) / 1000);
    const double mean = sum / static_cast<double>(values.size());
    const MipMap map(float_image(width, height, 3, values), ColorEncoding::linear, true);
    for (int level = 0; level < map.level_count(); ++level) {
      double level_sum = 0;
      const int w = map.width(level), h = map.height(level);
      for (int y = 0; y < h; ++y) {
        for (int x = 0; x < w; ++x) {
          const Vec4 t = map.bilinear(
              level, {(static_cast<float>(x) + 0.5f) / static_cast<float>(w), (static_cast<float>(y) + 0.5f) / static_cast<float>(h)},
              {Wrap::clamp, Wrap::clamp});
          level_sum += t.x + t.y + t.z;
        }
      }
      EXPECT_NEAR(level_sum / (3.0 * w * h), mean, 1e-5) << width << "x" << height << " level " << level;
    }
    EXPECT_EQ(map.width(map.level_count() - 1), 1);
    EXPECT_EQ(map.height(map.level_count() - 1), 1);
    EXPECT_NEAR((map.mean().x + map.mean().y + map.mean().z) / 3, mean, 1e-5);
  }
}

TEST(MipMap, EightBitLevelsKeepTheLinearMean) {
  const auto image = random_bytes(64, 64, 4);
  for (const ColorEncoding encoding : {ColorEncoding::srgb, ColorEncoding::linear}) {
    double color = 0, alpha = 0;
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        const float v = image->value(x, y, 0);
        color += encoding == ColorEncoding::srgb ? linear_from_srgb(v) : v;
        alpha += image->value(x, y, 3);
      }
    }
    const MipMap map(image, encoding, true);
    EXPECT_NEAR(map.mean().x, color / 4096, 1e-5);
    EXPECT_NEAR(map.mean().w, alpha / 4096, 1e-5);
    // The 1 x 1 level is rounded to a byte once: half a step of the curve at most.
    const Vec4 last = map.bilinear(map.level_count() - 1, {0.5f, 0.5f}, kRepeat);
    EXPECT_NEAR(last.x, color / 4096, 0.004);
    EXPECT_NEAR(last.w, alpha / 4096, 0.002);
  }
}

TEST(MipMap, EightBitLevelsTakeAThirdOfTheImage) {
  const auto image = random_bytes(256, 256, 3);
  const MipMap map(image, ColorEncoding::srgb, true);
  EXPECT_LT(map.memory_bytes(), image->size_bytes() / 3 + 5000);
}

TEST(MipMap, DecodesColourAsSrgbAndAlphaLinear) {
  const MipMap map(byte_image(1, 1, 4, {128, 64, 255, 128}), ColorEncoding::srgb, true);
  const Vec4 c = map.bilinear(0, {0.3f, 0.9f}, kRepeat);
  EXPECT_NEAR(c.x, linear_from_srgb(128 / 255.f), 1e-6f);
  EXPECT_NEAR(c.y, linear_from_srgb(64 / 255.f), 1e-6f);
  EXPECT_NEAR(c.z, 1, 1e-6f);
  EXPECT_NEAR(c.w, 128 / 255.f, 1e-6f);
}

TEST(MipMap, SpreadsGreyAndGreyAlpha) {
  const MipMap grey(byte_image(1, 1, 1, {51}), ColorEncoding::linear, true);
  EXPECT_EQ(grey.nearest({0, 0}, kRepeat), Vec4(0.2f, 0.2f, 0.2f, 1));
  const MipMap grey_alpha(byte_image(1, 1, 2, {51, 102}), ColorEncoding::linear, true);
  EXPECT_EQ(grey_alpha.nearest({0, 0}, kRepeat), Vec4(0.2f, 0.2f, 0.2f, 0.4f));
  const MipMap words(std::make_shared<const Image>(Image{1, 1, 1, Image::Words{32768}}), ColorEncoding::srgb, true);
  EXPECT_NEAR(words.nearest({0, 0}, kRepeat).x, linear_from_srgb(32768 / 65535.f), 1e-6f);
}

TEST(MipMap, ByteEncoderIsTheInverseOfTheDecoder) {
  for (const bool is_srgb : {true, false}) {
    const ByteDecoder decoder = make_byte_decoder(is_srgb);
    const ByteEncoder encode(decoder.color);
    for (std::size_t i = 0; i < 256; ++i) {
      EXPECT_EQ(encode(decoder.color[i]), i);
      const float below = decoder.color[i > 0 ? i - 1 : 0];
      EXPECT_EQ(encode(0.51f * decoder.color[i] + 0.49f * below), i);
    }
    EXPECT_EQ(encode(-1), 0);
    EXPECT_EQ(encode(7), 255);
    EXPECT_EQ(encode(NAN), 0);
  }
}

TEST(MipMap, FootprintsOfPowersOfTwoReadTheirLevel) {
  // A ramp of 8 texels in blocks of two: level 1 is 0 1 2 3, level 2 is 0.5 2.5.
  const MipMap map(float_image(8, 8, 1,
                               [] {
                                 std::vector<float> v;
                                 for (int y = 0; y < 8; ++y) v.insert(v.end(), {0, 0, 1, 1, 2, 2, 3, 3});
                                 return v;
                               }()),
                   ColorEncoding::linear, true);
  const Wraps clamp{Wrap::clamp, Wrap::clamp};
  const auto square = [](float size) { return Footprint{{size, 0}, {0, size}}; };
  EXPECT_NEAR(map.filtered({0.25f, 0.5f}, square(4 / 8.f), clamp).x, 0.5f, 1e-5f);
  EXPECT_NEAR(map.filtered({0.125f, 0.5f}, square(2 / 8.f), clamp).x, 0, 1e-5f);
  EXPECT_NEAR(map.filtered({0.375f, 0.5f}, square(2 / 8.f), clamp).x, 1, 1e-5f);
  EXPECT_NEAR(map.filtered({0.4f, 0.5f}, square(100), clamp).x, 1.5f, 1e-5f);
  // Half-way between levels 1 and 2 in log2.
  const float both = map.filtered({0.125f, 0.5f}, square(std::sqrt(8.f) / 8), clamp).x;
  EXPECT_NEAR(both, 0.5f * 0 + 0.5f * 0.5f, 1e-4f);
}

TEST(MipMap, AnisotropicFootprintKeepsSharpnessAcross) {
  // Vertical stripes one texel wide: a footprint long in v must keep them, one long in u must blur them. Also when rotated by 90°.
  std::vector<float> stripes;
  for (int i = 0; i < 64 * 64; ++i) stripes.push_back(i % 2 ? 1.f : 0.f);
  const MipMap map(float_image(64, 64, 1, stripes), ColorEncoding::linear, true);
  const float u = 1.5f / 64;
  EXPECT_NEAR(map.filtered({u, 0.5f}, {{1 / 64.f, 0}, {0, 8 / 64.f}}, kRepeat).x, 1, 1e-4f);
  EXPECT_NEAR(map.filtered({u, 0.5f}, {{0, 8 / 64.f}, {1 / 64.f, 0}}, kRepeat).x, 1, 1e-4f);
  EXPECT_NEAR(map.filtered({u, 0.5f}, {{8 / 64.f, 0}, {0, 1 / 64.f}}, kRepeat).x, 0.5f, 1e-4f);
  // Ratio 64 exceeds the probes: the minor axis grows to 64 / 8 texels.
  EXPECT_NEAR(map.filtered({u, 0.5f}, {{1 / 64.f, 0}, {0, 1}}, kRepeat).x, 0.5f, 1e-4f);
}

TEST(MipMap, FilteredRandomImageConvergesToTheMeanOfTheBox) {
  // The look-up over a rotated, stretched footprint comes close to the brute-force mean of the parallelogram.
  const MipMap map(random_bytes(128, 128, 1), ColorEncoding::linear, true);
  const Footprint footprint{{20 / 128.f, 12 / 128.f}, {-3 / 128.f, 5 / 128.f}};
  double error = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const Vec2 uv{0.05f * static_cast<float>(trial), 0.37f};
    double sum = 0;
    constexpr int n = 64;
    for (int i = 0; i < n * n; ++i) {
      const float a = (static_cast<float>(i % n) + 0.5f) / n - 0.5f, b = (static_cast<float>(i / n) + 0.5f) / n - 0.5f;
      sum += map.bilinear(0, uv + a * footprint.dx + b * footprint.dy, kRepeat).x;
    }
    error += std::fabs(map.filtered(uv, footprint, kRepeat).x - sum / (n * n));
  }
  EXPECT_LT(error / 20, 0.02);
}

TEST(MipMap, HostileCoordinatesAndFootprintsGiveFiniteValues) {
  const MipMap map(random_bytes(7, 5, 3), ColorEncoding::srgb, true);
  for (const Wrap wrap : {Wrap::repeat, Wrap::clamp, Wrap::mirror, Wrap::black}) {
    for (const float u : {-1e30f, -1e9f, -1.f, 0.f, 1.f, 3e8f, 3e38f}) {
      for (const float d : {0.f, 1e-30f, 1.f, 1e20f, 3e38f, INFINITY, NAN}) {
        const Vec4 c = map.filtered({u, -u}, {{d, 0}, {0, d}}, {wrap, wrap});
        EXPECT_TRUE(std::isfinite(c.x) && c.x >= 0 && c.x <= 1.001f) << u << " " << d;
        EXPECT_TRUE(std::isfinite(map.nearest({u, u}, {wrap, wrap}).x));
      }
    }
  }
}

}  // namespace
}  // namespace sightline
