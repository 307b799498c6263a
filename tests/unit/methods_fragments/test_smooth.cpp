// The filter over penumbrae: straight shadow borders in front of a square light, sampled as the method does.
#include "methods/fragments/smooth.h"

#include <gtest/gtest.h>

#include <cmath>

#include "methods/fragments/smooth_window.h"
#include "support/chi_square.h"
#include "test_upsample_support.h"

namespace sightline::test {
namespace {

/// The light is the unit square; a pixel sees of it what lies on one side of a line, which moves across it along a direction on screen.
struct Penumbra {
  float width = 16;       ///< pixels from full shadow to full light
  float direction = 0.5;  ///< of the shadow border on screen
  float tilt = 0.3f;      ///< of its image on the light

  float border(float x, float y) const {  // of u cos + v sin
    const float across = (x - 64) * std::cos(direction) + (y - 64) * std::sin(direction);
    return (across / width + 0.5f) * (std::cos(tilt) + std::sin(tilt));
  }
  bool sees(float x, float y, float u, float v) const { return u * std::cos(tilt) + v * std::sin(tilt) <= border(x, y); }
  float truth(float x, float y) const {
    const float c = std::cos(tilt), s = std::sin(tilt), b = border(x, y);
    const auto half_square = [](float a) { return a > 0 ? 0.5f * a * a : 0.f; };
    return (half_square(b) - half_square(b - c) - half_square(b - s) + half_square(b - c - s)) / (c * s);
  }
};

float sampled(const Penumbra& p, float x, float y, const std::vector<Vec2>& points) {
  int seen = 0;
  for (const Vec2& point : points) seen += p.sees(x, y, point.x, point.y);
  return static_cast<float>(seen) / static_cast<float>(points.size());
}
std::vector<Vec2> stratified(int a_side, Uniform& random) {
  std::vector<Vec2> points;
  for (int j = 0; j < a_side; ++j)
    for (int i = 0; i < a_side; ++i)
      points.push_back((Vec2(static_cast<float>(i), static_cast<float>(j)) + random.next2()) / static_cast<float>(a_side));
  return points;
}

/// A picture of 128 x 128 all at one level: 64 rays a pixel, or fragments whose four probes share 16 light points.
struct Sampled {
  GBuffer g = flat_picture(128, 128);
  LightSignal signal;
  std::vector<float> values;

  Sampled(const Penumbra& p, int level, std::uint32_t seed) {
    Uniform random(seed);
    signal.resize(g, 1);
    std::fill(signal.level.begin(), signal.level.end(), static_cast<std::uint8_t>(level));
    const int w = 1 << level, half = std::max(w / 2, 1), probes = level == 0 ? 1 : 2;
    for (int y = 0; y < 128; y += w)
      for (int x = 0; x < 128; x += w) {
        const std::vector<Vec2> points = stratified(level == 0 ? 8 : 4, random);
        for (int j = 0; j < probes; ++j)
          for (int i = 0; i < probes; ++i) {
            const float offset = 0.5f * static_cast<float>(half), px = static_cast<float>(x + i * half) + offset,
                        py = static_cast<float>(y + j * half) + offset;
            signal.value[0][g.at(x + i * half, y + j * half)] = sampled(p, px, py, points);
          }
      }
    values.resize(128 * 128);
    float* out[] = {values.data()};
    upsample(g, signal, {UpsampleOptions::Kind::quad4, 0, true}, g.root(0), out);
  }
  std::vector<float> smoothed() const {
    std::vector<float> out(values.size(), -7);
    smooth(g, values, signal.level, g.root(0), out);
    return out;
  }
};

double squared_error(const Penumbra& p, const std::vector<float>& values) {
  double sum = 0;
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 128; ++x)
      sum +=
          std::pow(values[static_cast<std::size_t>(y * 128 + x)] - p.truth(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f), 2);
  return sum;
}

/// Squared errors before and after, over borders of several directions.
std::pair<double, double> errors(float width, int level) {
  double before = 0, after = 0;
  std::uint32_t seed = 1;
  for (const float direction : {0.01f, 0.5f, 0.785f})
    for (const float tilt : {0.01f, 0.5f}) {
      const Penumbra p{width, direction, tilt};
      const Sampled s(p, level, seed++);
      before += squared_error(p, s.values), after += squared_error(p, s.smoothed());
    }
  return {before, after};
}

// Fragments of level 2 that are stable do not occur in narrower penumbrae: their probes would differ by two rays.
TEST(Smooth, WidePenumbraeHaveAThirdOfTheirErrorAtMost) {
  for (const int level : {0, 1, 2})
    for (const float width : {16.f, 24.f, 32.f, 48.f, 64.f}) {
      if (level == 2 && width < 48) continue;
      const auto [before, after] = errors(width, level);
      EXPECT_LE(after, before / 3) << "width " << width << ", level " << level;
    }
}

TEST(Smooth, SharpShadowsDoNotGetWorse) {
  for (const float width : {1.f, 2.f, 3.f, 4.f, 8.f}) {
    const auto [before, after] = errors(width, 0);
    EXPECT_LE(after, (width > 4 ? 1.02 : 1.0025) * before) << "width " << width;
  }
  // Stable fragments of 2 x 2 and 4 x 4 pixels do not occur here.
  for (const int level : {1, 2})
    for (const float width : {1.f, 2.f, 4.f}) {
      const auto [before, after] = errors(width, level);
      EXPECT_LE(after, 1.02 * before) << "width " << width << ", level " << level;
    }
}

TEST(Smooth, LeavesNoiseFreePicturesAlone) {
  // Fully lit, fully dark, and a border between them through the pixels.
  const GBuffer g = flat_picture(150, 140);
  const std::vector<std::uint8_t> level(g.depth.size(), 0);
  std::vector<float> values(g.depth.size());
  for (int y = 0; y < g.height; ++y)
    for (int x = 0; x < g.width; ++x) values[g.at(x, y)] = x + 0.3f * static_cast<float>(y) < 90 ? 1.f : 0.f;
  std::vector<float> out(values.size(), -7);
  for (std::size_t i = 0; i < g.root_count(); ++i) smooth(g, values, level, g.root(i), out);
  for (int y = 0; y < g.height; ++y)
    for (int x = 0; x < g.width; ++x) ASSERT_EQ(out[g.at(x, y)], values[g.at(x, y)]);
}

/// Noise on two planes that meet at column 70, on 5 % background pixels, and at mixed levels.
struct Messy {
  GBuffer g;
  std::vector<float> values;
  std::vector<std::uint8_t> level;

  Messy(int width, int height, std::uint32_t seed) : g(flat_picture(width, height)), values(g.depth.size()), level(g.depth.size()) {
    Uniform random(seed);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const std::size_t i = g.at(x, y);
        values[i] = std::clamp(static_cast<float>(x % 70) / 70 + 0.1f * (random.next() - 0.5f), 0.f, 1.f);
        level[i] = static_cast<std::uint8_t>(5 * ((x / 32 + y / 32) % 2) * random.next());
        if (x >= 70) store(g.shading_normal, i, {1, 0, 0}), store(g.geometric_normal, i, {1, 0, 0});
        if (x >= 70) store(g.position, i, Vec3{70, static_cast<float>(y), static_cast<float>(70 - x)} / 100.f);
        if (random.next() < 0.05f) {
          g.kind[i] = PixelKind::background;
          store(g.position, i, Vec3(std::numeric_limits<float>::quiet_NaN()));
        }
      }
  }
};

TEST(Smooth, LanesAgreeWithTheDefinitionOnEveryTarget) {
  for (const std::int64_t target : simd_targets()) {
    const PinnedTarget pinned(target);
    for (const auto& [width, height] : {std::pair{129, 131}, {1, 1}, {129, 3}, {128, 128}, {3, 129}}) {
      const Messy messy(width, height, 5);
      std::vector<float> out(messy.values.size(), -7);
      for (std::size_t i = 0; i < messy.g.root_count(); ++i) smooth(messy.g, messy.values, messy.level, messy.g.root(i), out);
      int changed = 0;
      for (int y = 0; y < messy.g.rows; ++y)
        for (int x = 0; x < messy.g.stride; ++x) {
          const std::size_t i = messy.g.at(x, y);
          if (!messy.g.inside(x, y)) {
            ASSERT_EQ(out[i], -7) << "written outside the picture";
            continue;
          }
          ASSERT_NEAR(out[i], smooth_pixel({messy.g, messy.values, messy.level}, x, y), 2e-5f) << x << ", " << y;
          changed += out[i] != messy.values[i];
        }
      EXPECT_GE(changed, width * height > 1000 ? width * height / 4 : 0);
    }
  }
}

TEST(Smooth, GeometricEdgesDoNotBleed) {
  // Dark noise on one wall, light noise on the other: neither side sees values of the other.
  Messy messy(140, 128, 6);
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 140; ++x)
      messy.values[messy.g.at(x, y)] = (x < 70 ? 0.4f : 0.45f) + 0.01f * static_cast<float>((x * 7 + y * 5) % 3 - 1);
  std::vector<float> out(messy.values.size());
  for (std::size_t i = 0; i < messy.g.root_count(); ++i) smooth(messy.g, messy.values, messy.level, messy.g.root(i), out);
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 140; ++x) ASSERT_NEAR(out[messy.g.at(x, y)], x < 70 ? 0.4f : 0.45f, 0.0101f) << x << ", " << y;
}

}  // namespace
}  // namespace sightline::test
