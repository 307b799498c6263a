// Pyramids of discontinuities, and the fragments that geometry leaves.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "methods/fragments/pyramid.h"
#include "test_upsample_support.h"
#include "unit/trace/trace_scenes.h"

namespace sightline::test {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Random normals and depths on most of the picture, background elsewhere.
GBuffer rough_picture(int width, int height, std::uint32_t seed, float background) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  GBuffer g = flat_picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t at = g.at(x, y);
      const Vec3 normal = random_direction(random);
      store(g.shading_normal, at, normal), store(g.geometric_normal, at, random_direction(random));
      store(g.position, at, random_point(random, 1));
      g.depth[at] = 1 + unit(random);
      if (unit(random) < background) g.kind[at] = PixelKind::background, g.depth[at] = kInfinity;
    }
  }
  return g;
}

/// The definition at a pixel, with the arc cosine of the paper.
struct Change {
  double kappa = 0, dz = 0;
};
Change change_at(const GBuffer& g, int x, int y, bool plane) {
  const auto surface = [&](int px, int py) { return g.kind[g.at(px, py)] == PixelKind::diffuse; };
  Change change;
  double squared = 0;
  for (const IVec2 step : {IVec2(1, 0), IVec2(0, 1)}) {
    if (x + step.x >= g.width || y + step.y >= g.height) continue;
    const std::size_t here = g.at(x, y), there = g.at(x + step.x, y + step.y);
    if (surface(x, y) != surface(x + step.x, y + step.y)) return {kInfinity, kInfinity};
    if (!surface(x, y)) continue;
    const double cosine = glm::dot(Vec3d(load(g.shading_normal, here)), Vec3d(load(g.shading_normal, there)));
    const double k = 2 * std::sin(std::acos(std::clamp(cosine, -1.0, 1.0)) / 2);
    squared += k * k;
    const double step_z =
        plane ? std::fabs(glm::dot(Vec3d(load(g.position, there)) - Vec3d(load(g.position, here)), Vec3d(load(g.geometric_normal, here))))
              : std::fabs(static_cast<double>(g.depth[there]) - static_cast<double>(g.depth[here]));
    change.dz = std::max(change.dz, step_z / static_cast<double>(g.depth[here]));
  }
  change.kappa = std::sqrt(squared);
  return change;
}

TEST(FragmentGeometry, FinestLevelIsTheDefinitionWithTheArcCosine) {
  for (const bool plane : {true, false}) {
    const GBuffer g = rough_picture(131, 67, 3, 0.f);
    for (std::size_t root = 0; root < g.root_count(); ++root) {
      DiscontinuityPyramid pyramid;
      pyramid.build(g, g.root(root), {.plane_distance = plane});
      const RootTile tile = g.root(root);
      for (int y = tile.y0; y < tile.y1; ++y) {
        for (int x = tile.x0; x < tile.x1; ++x) {
          const Change change = change_at(g, x, y, plane);
          ASSERT_NEAR(pyramid.curvature(0, x - tile.x0, y - tile.y0), change.kappa, 1e-5);
          ASSERT_NEAR(pyramid.depth_change(0, x - tile.x0, y - tile.y0), change.dz, 1e-5);
        }
      }
    }
  }
}

TEST(FragmentGeometry, EveryTexelIsTheMaximumOfItsPixels) {
  const GBuffer g = rough_picture(200, 140, 4, 0.002f);
  for (std::size_t root = 0; root < g.root_count(); ++root) {
    DiscontinuityPyramid pyramid;
    pyramid.build(g, g.root(root), {});
    for (int m = 1; m <= kRootLevel; ++m) {
      for (int y = 0; y < kRootSize >> m; ++y) {
        for (int x = 0; x < kRootSize >> m; ++x) {
          float kappa = 0, dz = 0;
          for (int j = 0; j < 1 << m; ++j) {
            for (int i = 0; i < 1 << m; ++i) {
              kappa = std::max(kappa, pyramid.curvature(0, (x << m) + i, (y << m) + j));
              dz = std::max(dz, pyramid.depth_change(0, (x << m) + i, (y << m) + j));
            }
          }
          ASSERT_EQ(pyramid.curvature(m, x, y), kappa) << m << ": " << x << ", " << y;
          ASSERT_EQ(pyramid.depth_change(m, x, y), dz) << m << ": " << x << ", " << y;
        }
      }
    }
  }
}

TEST(FragmentGeometry, ABorderBetweenSurfaceAndBackgroundIsInfiniteOnItsUpperLeftSide) {
  GBuffer g = flat_picture(128, 128);
  for (int y = 0; y < 128; ++y)
    for (int x = 40; x < 128; ++x) g.kind[g.at(x, y)] = PixelKind::background;
  DiscontinuityPyramid pyramid;
  pyramid.build(g, g.root(0), {});
  for (int x = 0; x < 128; ++x) {
    EXPECT_EQ(pyramid.curvature(0, x, 64) == kInfinity, x == 39) << x;
    EXPECT_EQ(pyramid.depth_change(0, x, 64) == kInfinity, x == 39) << x;
  }
}

// Every pixel with a surface lies in one fragment and none in two; fragments of more than a pixel hold surface alone, and no change above
// the thresholds except that of two pixels' depth.
TEST(FragmentGeometry, FragmentsTileTheSurfacesAndHoldNoDiscontinuity) {
  for (const float background : {0.f, 0.0005f, 0.5f, 1.f}) {
    GBuffer g = rough_picture(300, 135, 5, background);
    // Smooth but for a sprinkling of edges.
    std::mt19937 random(6);
    for (int y = 0; y < g.height; ++y)
      for (int x = 0; x < g.width; ++x) {
        const std::size_t at = g.at(x, y);
        store(g.shading_normal, at, random() % 700 == 0 ? Vec3{1, 0, 0} : Vec3{0, 0, 1});
        store(g.geometric_normal, at, {0, 0, 1});
        store(g.position, at, {static_cast<float>(x), static_cast<float>(y), random() % 300 == 0 ? 0.1f : 0.f});
      }
    for (const int coarsest : {7, 4, 1}) {
      const GeometryOptions options{.coarsest = coarsest};
      std::vector<int> covered(g.kind.size());
      for (std::size_t root = 0; root < g.root_count(); ++root) {
        DiscontinuityPyramid pyramid;
        std::vector<Fragment> fragments;
        pyramid.build(g, g.root(root), options);
        pyramid.refine(g, g.root(root), options, fragments);
        for (const Fragment& f : fragments) {
          ASSERT_LE(f.level, coarsest);
          ASSERT_EQ(f.x % f.width(), 0);
          ASSERT_EQ(f.y % f.width(), 0);
          for (int y = f.y; y < std::min(f.y + f.width(), g.height); ++y) {
            for (int x = f.x; x < std::min(f.x + f.width(), g.width); ++x) {
              ++covered[g.at(x, y)];
              ASSERT_EQ(g.kind[g.at(x, y)], PixelKind::diffuse);
              if (f.level == 0) continue;
              const Change change = change_at(g, x, y, true);
              ASSERT_LE(change.kappa, options.tau_n);
              ASSERT_TRUE(change.dz <= static_cast<double>(options.tau_d) || f.level == 1);
            }
          }
        }
      }
      for (int y = 0; y < g.height; ++y)
        for (int x = 0; x < g.width; ++x)
          ASSERT_EQ(covered[g.at(x, y)], g.kind[g.at(x, y)] == PixelKind::diffuse ? 1 : 0) << x << ", " << y;
    }
  }
}

TEST(FragmentGeometry, APlaneIsOneFragmentATile) {
  const GBuffer g = flat_picture(300, 200);
  for (std::size_t root = 0; root < g.root_count(); ++root) {
    DiscontinuityPyramid pyramid;
    std::vector<Fragment> fragments;
    pyramid.build(g, g.root(root), {});
    pyramid.refine(g, g.root(root), {}, fragments);
    ASSERT_EQ(fragments.size(), 1u);
    EXPECT_EQ(fragments[0].level, kRootLevel);
  }
}

}  // namespace
}  // namespace sightline::test
