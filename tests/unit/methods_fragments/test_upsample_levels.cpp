// Upsampling level by level against examples worked by hand.
#include <gtest/gtest.h>

#include "test_upsample_support.h"

namespace sightline::test {
namespace {

constexpr UpsampleOptions kOptions{.kind = UpsampleOptions::Kind::multipass, .copy_levels = 0};

// A picture of 4 x 4: fragments of 2 x 2 with a, b above and c below left; below right four single pixels.
TEST(UpsampleLevels, MatchesAnExampleWorkedByHand) {
  const GBuffer g = flat_picture(4, 4);
  const auto stop = [](int x, int y, int level) { return level == 1 && !(x == 2 && y == 2); };
  const LightSignal signal = cut(g, 1, stop, [](float x, float y) {
    if (x > 2 && y > 2) return 1.f;
    return y > 2 ? 0.4f : x > 2 ? 0.2f : 0.6f;
  });
  const auto v = upsample_all(g, signal, kOptions).channel[0];
  const float a = 0.6f, b = 0.2f, c = 0.4f;
  EXPECT_NEAR(v[0], a, 1e-6f);                             // a corner of the picture: nothing but its parent
  EXPECT_NEAR(v[1], (9 * a + 3 * b) / 12, 1e-6f);          // parent and the one to the right
  EXPECT_NEAR(v[4], (9 * a + 3 * c) / 12, 1e-6f);          // parent and the one below
  EXPECT_NEAR(v[5], (9 * a + 3 * b + 3 * c) / 15, 1e-6f);  // the fourth is refined: without value at this level
  EXPECT_NEAR(v[6], (9 * b + 3 * a + c) / 13, 1e-6f);      // its neighbour below is refined
  EXPECT_NEAR(v[9], (9 * c + 3 * a + b) / 13, 1e-6f);      // its neighbour to the right is refined
  EXPECT_NEAR(v[10], 1, 1e-6f);                            // samples of their own
  EXPECT_NEAR(v[15], 1, 1e-6f);
}

// Two levels: a fragment of 4 beside fragments of 2 of another value, in one dimension (the picture is one row of fragments high).
TEST(UpsampleLevels, CoarseFragmentsDoNotSeeFinerOnes) {
  const GBuffer g = flat_picture(8, 4);
  const auto stop = [](int x, int, int level) { return x < 4 ? level <= 2 : level <= 1; };
  const LightSignal signal = cut(g, 1, stop, [](float x, float) { return x < 4 ? 0.f : x < 6 ? 0.8f : 0.4f; });
  const auto v = upsample_all(g, signal, kOptions).channel[0];
  // At level 1 the fragment of 4 becomes texels of 0, next to texels of 0.8; at level 0 these are interpolated.
  const std::array<float, 8> expected = {0, 0, 0, 0.2f, 0.6f, 0.7f, 0.5f, 0.4f};
  for (std::size_t x = 0; x < 8; ++x)
    for (std::size_t y = 0; y < 4; ++y) EXPECT_NEAR(v[y * 8 + x], expected[x], 1e-6f) << x;
}

TEST(UpsampleLevels, TilesAgreeOnTheirBorders) {
  // Shifted by half a root tile, fragments up to 64 pixels lie alike: the picture must be the same, across tile borders too.
  const Field field = [](float x, float y) { return 0.5f + 0.3f * std::sin(0.1f * x) * std::cos(0.07f * y); };
  const auto shifted = [&](float x, float y) { return field(x + 64, y + 64); };
  const GBuffer g = flat_picture(384, 384), h = flat_picture(320, 320);
  const auto a = upsample_all(g, cut(g, 1, all_of_level(5), field), kOptions).channel[0];
  const auto b = upsample_all(h, cut(h, 1, all_of_level(5), shifted), kOptions).channel[0];
  for (std::size_t y = 0; y < 256; ++y)
    for (std::size_t x = 0; x < 256; ++x) ASSERT_NEAR(a[(y + 64 + 32) * 384 + x + 64 + 32], b[(y + 32) * 320 + x + 32], 1e-6f);
}

}  // namespace
}  // namespace sightline::test
