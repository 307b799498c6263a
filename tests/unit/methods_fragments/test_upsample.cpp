// Interpolation of fragments against fields whose values are known everywhere.
#include "methods/fragments/upsample.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "test_upsample_support.h"

namespace sightline::test {
namespace {

using Kind = UpsampleOptions::Kind;

std::vector<UpsampleOptions> all_options() {
  std::vector<UpsampleOptions> result;
  for (const Kind kind : {Kind::rbf, Kind::rbf_fixed, Kind::multipass, Kind::quad4})
    for (const int copy : {0, 2})
      for (const bool probes : {false, true}) result.push_back({kind, copy, probes});
  return result;
}
std::string name(const UpsampleOptions& o) {
  return "kind " + std::to_string(static_cast<int>(o.kind)) + ", copy " + std::to_string(o.copy_levels) + ", probes " +
         std::to_string(o.interpolate_probes);
}

/// Largest difference from the field at pixels of [x0, x1) x [y0, y1).
float largest_error(const GBuffer& g, const Upsampled& u, const Field& field, int x0, int y0, int x1, int y1, int c = 0) {
  float worst = 0;
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      const float truth = static_cast<float>(c + 1) * field(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      const float error = std::abs(u.channel[static_cast<std::size_t>(c)][static_cast<std::size_t>(y * g.width + x)] - truth);
      worst = error <= worst ? worst : error;  // NaN sticks
    }
  return worst;
}

TEST(Upsample, ReproducesConstantFieldsOnAnyFragments) {
  const GBuffer g = flat_picture(300, 200);
  const Field field = [](float, float) { return 0.3f; };
  for (const int channels : {1, 3})
    for (const std::uint32_t seed : {1u, 2u}) {
      const LightSignal signal = cut(g, channels, mixture(seed), field);
      for (const UpsampleOptions& options : all_options()) {
        const Upsampled u = upsample_all(g, signal, options);
        EXPECT_TRUE(u.in_bounds) << name(options);
        for (int c = 0; c < channels; ++c) EXPECT_LE(largest_error(g, u, field, 0, 0, 300, 200, c), 1e-6f * (c + 1)) << name(options);
      }
    }
}

TEST(Upsample, CopiesSmallFragmentsQuadrantByQuadrant) {
  const GBuffer g = flat_picture(150, 140);
  const Field field = [](float x, float y) { return 0.5f + 0.4f * std::sin(x) * std::cos(0.7f * y); };
  for (const int level : {0, 1, 2}) {
    const LightSignal signal = cut(g, 1, all_of_level(level), field);
    for (const Kind kind : {Kind::rbf, Kind::multipass, Kind::quad4})
      for (const bool probes : {false, true}) {
        const Upsampled u = upsample_all(g, signal, {kind, 2, probes});
        const int size = level == 2 ? 2 : 1;
        for (int y = 0; y < g.height; ++y)
          for (int x = 0; x < g.width; ++x)
            ASSERT_EQ(u.channel[0][static_cast<std::size_t>(y * g.width + x)], signal.value[0][g.at(x / size * size, y / size * size)]);
      }
  }
}

// Equal fragments of probes make a lattice, on which patches are bilinear interpolation, exact for linear fields. Additional samples lie
// half a pixel off the nodes they stand for, which moves the field by a quarter of what it changes in a pixel in either direction.
TEST(Upsample, PatchesReproduceLinearFieldsOnEqualFragments) {
  const GBuffer g = flat_picture(384, 384);
  const Field field = [](float x, float y) { return 0.1f + 0.001f * x + 0.0007f * y; };
  for (const int level : {2, 3, 4, 5}) {
    const Upsampled exact = upsample_all(g, cut(g, 1, all_of_level(level), field, false), {Kind::quad4, 0, true});
    EXPECT_LE(largest_error(g, exact, field, 64, 64, 320, 320), 1e-6f);
    const Upsampled u = upsample_all(g, cut(g, 1, all_of_level(level), field), {Kind::quad4, 0, true});
    EXPECT_LE(largest_error(g, u, field, 64, 64, 320, 320), 0.25f * 0.0017f + 1e-6f);
  }
}

TEST(Upsample, QuadrantCornersFollowLinearFieldsOnEqualFragments) {
  const GBuffer g = flat_picture(384, 384);
  const Field field = [](float x, float y) { return 0.1f + 0.001f * x + 0.0007f * y; };
  const float range = 384 * 0.0017f;
  for (const int level : {3, 4, 5, 6}) {
    const Upsampled u = upsample_all(g, cut(g, 1, all_of_level(level), field), {Kind::quad4, 2, false});
    EXPECT_LE(largest_error(g, u, field, 0, 0, 320, 320), 0.005f * range) << "level " << level;
  }
}

TEST(Upsample, IsContinuousWhereFragmentsOfDifferentSizesMeet) {
  const GBuffer g = flat_picture(384, 256);
  const Field field = [](float x, float y) { return 0.5f + 0.4f * std::sin(0.02f * x) * std::cos(0.013f * y); };
  for (const std::uint32_t seed : {3u, 4u, 5u}) {
    // Fragments of 4 to 128 pixels: no cell is smaller than 2 pixels, so a jump is seen against the slope within it.
    const auto stop = [&](int x, int y, int level) { return level == 2 || mixture(seed)(x, y, level); };
    const Upsampled u = upsample_all(g, cut(g, 1, stop, field), {Kind::quad4, 0, true});
    float steepest = 0;
    for (int y = 0; y < g.height; ++y)
      for (int x = 0; x + 1 < g.width; ++x) {
        const std::size_t i = static_cast<std::size_t>(y * g.width + x);
        steepest = std::max(steepest, std::abs(u.channel[0][i + 1] - u.channel[0][i]));
      }
    EXPECT_LE(steepest, 0.08f);
  }
}

/// Left of column `edge` lies another surface: turned away, far behind, a step of a stair, or the background.
enum class Beyond { turned, behind, step, background, unlit };
void put_edge(GBuffer& g, LightSignal* signal, int edge, Beyond beyond) {
  for (int y = 0; y < g.height; ++y)
    for (int x = 0; x < edge; ++x) {
      const std::size_t i = g.at(x, y);
      const Vec3 p = load(g.position, i);
      if (beyond == Beyond::turned) store(g.shading_normal, i, {1, 0, 0}), store(g.geometric_normal, i, {1, 0, 0});
      if (beyond == Beyond::behind) store(g.position, i, p - Vec3{0, 0, 3}), g.depth[i] = 13;
      if (beyond == Beyond::step && x % 8 == 7) store(g.position, i, p - Vec3{0, 0, 0.1f});
      if (beyond == Beyond::background) g.kind[i] = PixelKind::background, g.depth[i] = std::numeric_limits<float>::infinity();
      if (beyond == Beyond::unlit && signal) signal->flags[i] |= LightSignal::kUnlit;
    }
}

TEST(Upsample, GeometricEdgesDoNotBleed) {
  const int edge = 160;  // fragments up to 32 pixels touch it
  const Field field = [&](float x, float) { return x < static_cast<float>(edge) ? 0.f : 0.8f; };
  for (const Beyond beyond : {Beyond::turned, Beyond::behind, Beyond::background, Beyond::unlit}) {
    for (const std::uint32_t seed : {6u, 7u}) {
      GBuffer g = flat_picture(320, 130);
      const auto stop = [&](int x, int y, int level) { return !(x < edge && x + (1 << level) > edge) && mixture(seed, 2)(x, y, level); };
      LightSignal signal = cut(g, 1, stop, field);
      put_edge(g, &signal, edge, beyond);
      for (const UpsampleOptions& options : all_options()) {
        // The method of Nichols et al. knows no edges, only values that are none.
        if (options.kind == Kind::multipass && (beyond == Beyond::turned || beyond == Beyond::behind)) continue;
        const Upsampled u = upsample_all(g, signal, options);
        EXPECT_LE(largest_error(g, u, field, 0, 0, 320, 130), 1e-6f) << name(options) << " beyond " << static_cast<int>(beyond);
      }
    }
  }
}

TEST(Upsample, TheEdgeOfAStairIsAnEdgeHoweverLow) {
  GBuffer g = flat_picture(64, 64);
  // A step of a hundredth of the depth after column 16: ten pixels' width high.
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 16; ++x) store(g.position, g.at(x, y), load(g.position, g.at(x, y)) - Vec3{0, 0, 0.1f});
  const Field field = [](float x, float) { return x < 16 ? 0.f : 0.8f; };
  const auto stop = [](int, int, int level) { return level <= 3; };
  const Upsampled u = upsample_all(g, cut(g, 1, stop, field), {Kind::quad4, 2, true});
  EXPECT_LE(largest_error(g, u, field, 0, 0, 64, 64), 1e-6f);
}

TEST(Upsample, WorksOnPicturesOfAnySize) {
  const Field field = [](float x, float y) { return 0.5f + 0.2f * std::sin(0.3f * x + 0.2f * y); };
  for (const auto& [width, height] : {std::pair{1, 1}, {129, 3}, {2, 131}, {128, 128}, {257, 129}, {7, 5}}) {
    const GBuffer g = flat_picture(width, height);
    for (const int channels : {1, 3})
      for (const std::uint32_t seed : {8u, 9u}) {
        const LightSignal signal = cut(g, channels, mixture(seed), field);
        for (const UpsampleOptions& options : all_options()) {
          const Upsampled u = upsample_all(g, signal, options);
          EXPECT_TRUE(u.in_bounds);
          for (int c = 0; c < channels; ++c)
            for (const float v : u.channel[static_cast<std::size_t>(c)])
              ASSERT_TRUE(v >= 0.f && v <= 0.8f * static_cast<float>(c + 1)) << name(options) << ": " << v;
        }
      }
  }
}

/// Root mean square error over all pixels.
float rms(const GBuffer& g, const Upsampled& u, const Field& field) {
  double sum = 0;
  for (int y = 0; y < g.height; ++y)
    for (int x = 0; x < g.width; ++x)
      sum += std::pow(
          u.channel[0][static_cast<std::size_t>(y * g.width + x)] - field(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f), 2.);
  return static_cast<float>(std::sqrt(sum / (g.width * g.height)));
}

TEST(Upsample, SmoothFieldsAreMetBetterThanByConstantFragments) {
  const GBuffer g = flat_picture(384, 256);
  const Field field = [](float x, float y) { return 0.5f + 0.4f * std::sin(0.02f * x) * std::cos(0.013f * y); };
  for (const std::uint32_t seed : {10u, 11u}) {
    const LightSignal signal = cut(g, 1, [&](int x, int y, int level) { return level <= 5 && mixture(seed, 2)(x, y, level); }, field);
    const auto error = [&](Kind kind, int copy, bool probes) { return rms(g, upsample_all(g, signal, {kind, copy, probes}), field); };
    const float quadrants = error(Kind::rbf, 7, false);  // copies
    EXPECT_LT(error(Kind::rbf, 2, false), 0.9f * quadrants) << "rbf";
    EXPECT_LT(error(Kind::quad4, 2, false), 0.6f * quadrants) << "quad4";
    EXPECT_LT(error(Kind::rbf, 0, true), 0.6f * quadrants) << "rbf of probes";
    EXPECT_LT(error(Kind::quad4, 0, true), 0.3f * quadrants) << "patches";
  }
}

}  // namespace
}  // namespace sightline::test
