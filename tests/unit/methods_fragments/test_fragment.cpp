// The pure logic: what masks mean, and what becomes of a fragment that splits.
#include "methods/fragments/fragment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <set>

#include "methods/fragments/probe_test.h"

namespace sightline {
namespace {

std::uint64_t or_of_all_xors(const ProbeMasks& m) {
  return (m[0] ^ m[1]) | (m[0] ^ m[2]) | (m[0] ^ m[3]) | (m[1] ^ m[2]) | (m[1] ^ m[3]) | (m[2] ^ m[3]);
}

TEST(FragmentMasks, DifferenceIsTheOrOfAllSixPairs) {
  for (unsigned pattern = 0; pattern < 16; ++pattern) {
    const ProbeMasks masks = {pattern & 1, pattern >> 1 & 1, pattern >> 2 & 1, pattern >> 3 & 1};
    EXPECT_EQ(ray_difference(masks), or_of_all_xors(masks)) << pattern;
  }
  std::mt19937_64 random(1);
  for (int i = 0; i < 1000000; ++i) {
    // Bits that agree are rare in four random numbers: half of the cases differ in a few bits alone.
    ProbeMasks masks = {random(), random(), random(), random()};
    if (i % 2 == 0) masks[1] = masks[2] = masks[0], masks[3] = masks[0] ^ (random() & random() & random());
    ASSERT_EQ(ray_difference(masks), or_of_all_xors(masks));
  }
}

TEST(FragmentMasks, CountsRunFromNothingToAllPoints) {
  for (int rays : {16, 32, 64}) {
    const std::uint64_t all = rays == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << rays) - 1;
    for (std::size_t q = 0; q < 4; ++q) {
      ProbeMasks masks{};
      EXPECT_EQ(most_visible(masks), 0);
      masks[q] = all;
      EXPECT_EQ(most_visible(masks), rays);
      masks[q] = all & 0x5555555555555555u;
      EXPECT_EQ(most_visible(masks), rays / 2);
    }
  }
}

TEST(FragmentThreshold, IsTwoOfSixteenUpToFourPixelsAndOneFromEightOn) {
  const SplitOptions at_least{}, more_than{.strict_threshold = true};
  for (int level = 1; level <= 7; ++level) {
    const int expected = level <= 2 ? 2 : 1;
    EXPECT_EQ(threshold(level, at_least), expected) << level;
    EXPECT_EQ(threshold(level, more_than), expected + 1) << level;
    EXPECT_EQ(threshold(level, {.pixel_threshold = 4}), level == 1 ? 4 : expected) << level;
    EXPECT_EQ(threshold(level, {.rays = 32}), 2 * expected) << level;
    EXPECT_EQ(threshold(level, {.rays = 64}), 4 * expected) << level;
    for (int differing = 0; differing <= 4; ++differing) {
      const ProbeMasks masks = {(std::uint64_t{1} << differing) - 1, 0, 0, 0};
      EXPECT_EQ(is_stable(level, masks, at_least), differing < expected) << level << ": " << differing;
      EXPECT_EQ(is_stable(level, masks, more_than), differing <= expected) << level << ": " << differing;
    }
  }
}

// Quadrant q is fine if one of the two quadrants beside it (never the one across) differs in more than the gradient.
TEST(FragmentGradient, MarksBothQuadrantsOfASteepPairThatSharesAnEdge) {
  std::mt19937_64 random(2);
  for (const int rays : {16, 32, 64}) {
    const SplitOptions options{.rays = rays};
    const std::uint64_t all = rays == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << rays) - 1;
    for (int i = 0; i < 10000; ++i) {
      ProbeMasks masks;
      for (std::uint64_t& mask : masks) mask = (random() & (random() % 2 ? random() : ~std::uint64_t{0})) & all;
      unsigned expected = 0;
      for (unsigned q = 0; q < 4; ++q) {
        const auto steep = [&](unsigned beside) { return 16 * std::popcount(masks[q] ^ masks[beside]) > 7 * rays; };
        if (steep(q ^ 1) || steep(q ^ 2)) expected |= 1u << q;
      }
      ASSERT_EQ(fine_quadrants(masks, options), expected);
      ASSERT_EQ(fine_quadrants(masks, {.rays = rays, .subdivide_twice = false}), 0u);
    }
    // Seven of sixteen are not yet steep, eight are.
    const std::uint64_t seven = (std::uint64_t{1} << (rays * 7 / 16)) - 1;
    EXPECT_EQ(fine_quadrants({seven, 0, 0, 0}, options), 0u);
    EXPECT_EQ(fine_quadrants({seven << 1 | 1, 0, 0, 0}, options), 0b0111u);
  }
}

// Written down level by level and quadrant by quadrant, not computed the way subdivide() does.
TEST(FragmentSubdivision, GivesTheExpectedChildrenForAllCombinationsAndLevels) {
  for (int level = 1; level <= 7; ++level) {
    const int w = 1 << level;
    for (unsigned fine = 0; fine < 16; ++fine) {
      const Fragment parent{static_cast<std::uint16_t>(3 * w), static_cast<std::uint16_t>(5 * w), static_cast<std::uint8_t>(level)};
      std::set<std::array<int, 3>> expected;
      for (int q = 0; q < 4; ++q) {
        const int x = 3 * w + (q % 2) * w / 2, y = 5 * w + (q / 2) * w / 2;
        if (level == 1 || (fine & (1u << q)) == 0) {
          expected.insert({x, y, level - 1});
          continue;
        }
        for (int i = 0; i < 2; ++i)
          for (int j = 0; j < 2; ++j) expected.insert({x + i * w / 4, y + j * w / 4, level - 2});
      }
      std::vector<Fragment> children;
      subdivide(parent, fine, children);
      std::set<std::array<int, 3>> found;
      for (const Fragment& f : children) found.insert({f.x, f.y, f.level});
      EXPECT_EQ(found, expected) << "level " << level << ", fine " << fine;
      EXPECT_EQ(children.size(), found.size()) << "a child came twice";
      // They tile their parent.
      std::vector<int> covered(static_cast<std::size_t>(w) * static_cast<std::size_t>(w));
      for (const Fragment& f : children)
        for (int y = f.y; y < f.y + f.width(); ++y)
          for (int x = f.x; x < f.x + f.width(); ++x) ++covered[static_cast<std::size_t>((y - 5 * w) * w + x - 3 * w)];
      EXPECT_TRUE(std::ranges::all_of(covered, [](int n) { return n == 1; }));
    }
  }
}

// The point of probe strata: together a quadrant's four probes ask all points, each of them one of every block of neighbours.
TEST(FragmentStrata, FourProbesShareOutTheLightEvenly) {
  struct Case {
    std::uint32_t count;
    int columns, rows;
  };
  for (const Case& c : {Case{16, 4, 4}, Case{32, 8, 4}, Case{64, 8, 8}}) {
    std::array<std::uint32_t, 4> asked{};
    for (int by = 0; by < c.rows; by += 2) {
      for (int bx = 0; bx < c.columns; bx += 2) {
        std::set<int> probes;
        for (int i = 0; i < 4; ++i) {
          const int probe = sub_probe_of(static_cast<std::uint32_t>((by + i / 2) * c.columns + bx + i % 2), c.count);
          ASSERT_GE(probe, 0);
          ASSERT_LT(probe, 4);
          probes.insert(probe);
          ++asked[static_cast<std::size_t>(probe)];
        }
        EXPECT_EQ(probes.size(), 4u) << c.count << " points, block " << bx << ", " << by;
      }
    }
    for (const std::uint32_t n : asked) EXPECT_EQ(n, c.count / 4);
  }
}

TEST(FragmentProbes, LieInTheirQuadrantsAndInThePicture) {
  GBuffer g;
  g.width = 200, g.height = 150;
  for (int level = 1; level <= 7; ++level) {
    const int w = 1 << level;
    const Fragment f{static_cast<std::uint16_t>(128 / w * w), static_cast<std::uint16_t>(128 / w * w), static_cast<std::uint8_t>(level)};
    for (int q = 0; q < 4; ++q) {
      for (int sub = level >= kManyProbesLevel ? 0 : -1; sub < (level >= kManyProbesLevel ? 4 : 0); ++sub) {
        const IVec2 p = probe_pixel(g, f, q, sub);
        const int x0 = f.x + q % 2 * w / 2, y0 = f.y + q / 2 * w / 2;
        EXPECT_LT(p.x, g.width);
        EXPECT_LT(p.y, g.height);
        EXPECT_TRUE(p.x >= std::min(x0, g.width - 1) && p.x < x0 + w / 2) << level << ", " << q << ", " << sub;
        EXPECT_TRUE(p.y >= std::min(y0, g.height - 1) && p.y < y0 + w / 2) << level << ", " << q << ", " << sub;
      }
    }
  }
}

}  // namespace
}  // namespace sightline
