// Probes and what refinement makes of a picture.
#include "methods/fragments/refiner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "base/math/vec3_batch.h"
#include "support/radiometry.h"
#include "test_fragments_support.h"

namespace sightline::test {
namespace {

LightPoints points_of(const Stage& stage, std::uint32_t rays) { return light_points(stage.shot.world->lights(), stage.lights[0], rays, 0); }

// Every quadrant's bits follow from where its probes are and where the edge is; a fragment is flagged where the edge separates its
// quadrants for enough points of the light.
TEST(FragmentProbes, SeeAHalfPlanesShadowAsBruteForceDoes) {
  for (const std::uint32_t rays : {16u, 32u, 64u}) {
    const EdgeScene edge{0.4f, 0.2f};
    Stage stage(edge.scene(), {256, 192});
    const LightPoints points = points_of(stage, rays);
    ProbeTest probes(*stage.shot.world, stage.view, *stage.visibility, 0);
    probes.set_light(stage.lights[0], points);
    const SplitOptions options{.rays = static_cast<int>(rays)};
    for (int level = 1; level <= kRootLevel; ++level) {
      std::vector<Fragment> fragments;
      // All of the coarse ones, a sample of the fine ones.
      const int w = 1 << level, step = std::max(w, 4 * w * (level < 3));
      for (int y = 0; y < stage.g.height; y += step)
        for (int x = 0; x < stage.g.width; x += w)
          fragments.push_back({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y), static_cast<std::uint8_t>(level)});
      std::vector<ProbeMasks> masks;
      probes.begin(0);
      probes.test(stage.g, fragments, masks, stage.statistics);
      int flagged = 0;
      for (std::size_t i = 0; i < fragments.size(); ++i) {
        const Fragment& f = fragments[i];
        int separated = 0;
        ProbeMasks expected{};
        for (std::uint32_t k = 0; k < rays; ++k) {
          const std::size_t point = static_cast<std::size_t>(probes.set_of(f)) * rays + k;
          int seen = 0;
          for (int q = 0; q < 4; ++q) {
            const int sub = level < kManyProbesLevel ? -1 : sub_probe_of(k, rays);
            const IVec2 pixel = probe_pixel(stage.g, f, q, sub);
            const float clearance = edge.clearance(load(stage.g.position, stage.g.at(pixel.x, pixel.y)), load(points.point, point));
            // Rays that graze the edge may do as they like.
            const bool sees = std::fabs(clearance) < EdgeScene::kGrazing ? masks[i][static_cast<std::size_t>(q)] >> k & 1 : clearance > 0;
            expected[static_cast<std::size_t>(q)] |= static_cast<std::uint64_t>(sees) << k;
            seen += sees;
          }
          separated += seen != 0 && seen != 4;
        }
        ASSERT_EQ(masks[i], expected) << rays << " rays, level " << level << ": " << f.x << ", " << f.y;
        ASSERT_EQ(!is_stable(level, masks[i], options), separated >= threshold(level, options));
        flagged += separated >= threshold(level, options);
      }
      EXPECT_TRUE(level < 3 || flagged > 0) << level;
      EXPECT_TRUE(level >= 6 || flagged < static_cast<int>(fragments.size())) << level;
    }
  }
}

TEST(FragmentProbes, SetsOfLightPointsAreStratifiedAndDifferBetweenFragments) {
  Stage stage(lamp_over_floor(Occluder::none), {16, 16});
  for (const std::uint32_t rays : {16u, 32u, 64u}) {
    const LightPoints points = points_of(stage, rays);
    const int columns = rays == 16 ? 4 : 8, rows = static_cast<int>(rays) / columns;
    for (std::uint32_t set = 0; set < LightPoints::kSets; ++set) {
      float area = 0;
      std::vector<int> strata(rays);
      for (std::uint32_t k = 0; k < rays; ++k) {
        const Vec3 p = load(points.point, static_cast<std::size_t>(set) * rays + k) - Vec3(0.2f, 4, -0.1f);
        const int i = std::min(static_cast<int>((p.x + 0.5f) * static_cast<float>(columns)), columns - 1);
        const int j = std::min(static_cast<int>((p.z + 0.5f) * static_cast<float>(rows)), rows - 1);
        ++strata[static_cast<std::size_t>(j * columns + i)];
        area += points.area[static_cast<std::size_t>(set) * rays + k];
      }
      ASSERT_TRUE(std::ranges::all_of(strata, [](int n) { return n == 1; })) << set;
      ASSERT_NEAR(area, 1, 1e-5);
    }
    EXPECT_NE(load(points.point, 0), load(points.point, rays));
  }
}

struct Refined {
  LightSignal signal;
  RefinementCounts counts;
};
Refined refine(Stage& stage, const FragmentOptions& options, int channels) {
  Refined refined;
  refined.signal.resize(stage.g, channels);
  const LightPoints points = points_of(stage, static_cast<std::uint32_t>(options.split.rays));
  Refiner refiner(*stage.shot.world, stage.view, *stage.visibility, options, 0);
  refiner.set_light(stage.lights[0], points);
  std::vector<TileProgress> progress(stage.g.root_count());
  for (std::size_t root = 0; root < progress.size(); ++root)
    refiner.refine(stage.g, root, stage.geometry(root, options.geometry), 0, refined.signal, progress[root], stage.statistics);
  for (int round = 1; round <= options.border_rounds; ++round) {
    for (TileProgress& p : progress) refiner.find_borders(stage.g, refined.signal, round, p);
    for (std::size_t root = 0; root < progress.size(); ++root)
      refiner.refine_borders(stage.g, root, 0, round, refined.signal, progress[root], stage.statistics);
  }
  refined.counts = refiner.counts();
  return refined;
}

FragmentOptions options_of(const char* variant, int rays = 16) {
  SettingsValue settings = find_method("fragments").default_settings();
  settings.apply(std::string("variant=") + variant), settings.apply("rays=" + std::to_string(rays));
  return resolve(settings.as<FragmentsSettings>());
}

TEST(FragmentRefiner, StableFragmentsAndPixelsTileTheSurfacesOnce) {
  Stage stage(box_on_floor(), {200, 150});
  for (const char* variant : {"sightline", "koa"}) {
    for (const int rays : {16, 64}) {
      const Refined refined = refine(stage, options_of(variant, rays), variant[0] == 's' ? 1 : 3);
      const std::vector<Fragment> fragments = fragments_of(stage, refined.signal);
      ASSERT_FALSE(fragments.empty());
      EXPECT_EQ(refined.counts.fragments, fragments.size()) << variant << ", " << rays;
      const auto pixels = static_cast<std::uint64_t>(std::ranges::count_if(fragments, [&](const Fragment& f) {
        return f.level == 0 && !(refined.signal.flags[stage.g.at(f.x, f.y)] & LightSignal::kUnlit);
      }));
      EXPECT_EQ(refined.counts.finest, pixels) << variant << ", " << rays;
      // The shadow's border is refined, and only a part of the picture is.
      EXPECT_GT(pixels, 100u);
      EXPECT_LT(pixels, 200u * 150u / 2);
    }
  }
}

TEST(FragmentRefiner, NothingSplitsWhereNothingOccludes) {
  Stage stage(lamp_over_floor(Occluder::none), {256, 192});
  for (const char* variant : {"sightline", "koa"}) {
    const Refined refined = refine(stage, options_of(variant), variant[0] == 's' ? 1 : 3);
    std::size_t geometric = 0;
    for (std::size_t root = 0; root < stage.g.root_count(); ++root) geometric += stage.geometry(root).size();
    EXPECT_EQ(refined.counts.fragments, geometric);
    EXPECT_EQ(refined.counts.finest, 0u);
    if (variant[0] != 's') continue;
    for (const Fragment& f : fragments_of(stage, refined.signal))
      for (int q = 0; q < 4; ++q)
        EXPECT_EQ(refined.signal.value[0][stage.g.at(f.x + q % 2 * f.width() / 2, f.y + q / 2 * f.width() / 2)], 1.f);
  }
}

TEST(FragmentRefiner, NothingSplitsWhereNothingIsLit) {
  Stage stage(lamp_over_floor(Occluder::everything), {256, 192});
  for (const char* variant : {"sightline", "koa"}) {
    const Refined refined = refine(stage, options_of(variant), 1);
    EXPECT_EQ(refined.counts.fragments,
              stage.geometry(0).size() + stage.geometry(1).size() + stage.geometry(2).size() + stage.geometry(3).size());
    for (const Fragment& f : fragments_of(stage, refined.signal))
      for (int q = 0; q < 4; ++q)
        EXPECT_EQ(refined.signal.value[0][stage.g.at(f.x + q % 2 * f.width() / 2, f.y + q / 2 * f.width() / 2)], 0.f);
  }
}

// Of a rectangle without shadows, at the fragment's centre.
TEST(FragmentIrradiance, IsLambertsFormula) {
  Stage stage(lamp_over_floor(Occluder::none), {128, 128});
  const std::array<Vec3d, 4> corners = {Vec3d(-0.3, 4, -0.6), Vec3d(0.7, 4, -0.6), Vec3d(0.7, 4, 0.4), Vec3d(-0.3, 4, 0.4)};
  const auto truth = [&](int x, int y) {
    return 8 * polygon_irradiance(Vec3d(load(stage.g.position, stage.g.at(x, y))), Vec3d(0, 1, 0), corners) / kPi;
  };
  FragmentOptions options = options_of("koa", 64);
  const LightPoints points = points_of(stage, 64);
  Refiner refiner(*stage.shot.world, stage.view, *stage.visibility, options, 0);
  refiner.set_light(stage.lights[0], points);
  LightSignal signal;
  signal.resize(stage.g, 3);
  for (std::uint16_t y = 0; y < 128; y += 16) {
    for (std::uint16_t x = 0; x < 128; x += 16) {
      const std::uint64_t all = ~std::uint64_t{0};
      refiner.write_stable(stage.g, {x, y, 4}, {all, all, all, all}, signal);
      const double expected = truth(x + 8, y + 8);
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(signal.value[static_cast<std::size_t>(c)][stage.g.at(x, y)], expected, 0.01 * expected);
      // All sets together are many samples.
      double sum = 0;
      const Receiver receiver = receiver_at(stage.g, x + 8, y + 8);
      for (std::size_t i = 0; i < LightPoints::kSets * 64; ++i)
        sum += 8.0 * static_cast<double>(geometry_term(receiver, load(points.point, i), load(points.normal, i), false) * points.area[i]);
      ASSERT_NEAR(sum / LightPoints::kSets, expected, 0.0005 * expected);
      // Half of the light seen is half the irradiance, about.
      refiner.write_stable(stage.g, {x, y, 4}, {all, 0, all, 0}, signal);
      ASSERT_NEAR(signal.value[0][stage.g.at(x, y)], expected / 2, 0.005 * expected);
    }
  }
}

TEST(FragmentIrradiance, OfPixelsIsLambertsFormula) {
  Stage stage(lamp_over_floor(Occluder::none), {64, 64});
  const std::array<Vec3d, 4> corners = {Vec3d(-0.3, 4, -0.6), Vec3d(0.7, 4, -0.6), Vec3d(0.7, 4, 0.4), Vec3d(-0.3, 4, 0.4)};
  for (const std::uint32_t rays : {64u, 4096u}) {
    FinestTest finest(*stage.shot.world, stage.view, *stage.visibility, {.rays = rays, .smooth_rays = rays, .early_out = false}, 0);
    finest.begin(0);
    std::vector<std::uint32_t> pixels;
    for (int y = 3; y < 64; y += 16)
      for (int x = 5; x < 64; x += 16) pixels.push_back(static_cast<std::uint32_t>(stage.g.at(x, y)));
    std::array<std::vector<float>, 3> values;
    finest.test(stage.g, stage.lights[0], pixels, 0, rays, 3, values, stage.statistics);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const double expected = 8 * polygon_irradiance(Vec3d(load(stage.g.position, pixels[i])), Vec3d(0, 1, 0), corners) / kPi;
      ASSERT_NEAR(values[0][i], expected, (rays == 64 ? 0.01 : 0.0005) * expected) << rays;
    }
    finest.test(stage.g, stage.lights[0], pixels, 0, rays, 1, values, stage.statistics);
    for (std::size_t i = 0; i < pixels.size(); ++i) ASSERT_EQ(values[0][i], 1.f);
  }
}

}  // namespace
}  // namespace sightline::test
