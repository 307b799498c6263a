// Refinement by comparing neighbours: its rule, and what becomes of a picture.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>

#include "base/math/vec3_batch.h"
#include "methods/fragments/nichols_refiner.h"
#include "test_fragments_support.h"

namespace sightline::test {
namespace {

using Cells = std::vector<std::vector<NicholsCell>>;

// The rule as it is told: who differs from a neighbour splits, and where a fragment differs from a neighbour across a corner, so do the
// two beside both.
std::vector<std::vector<bool>> told(const Cells& cells, int threshold) {
  const int rows = static_cast<int>(cells.size()), columns = static_cast<int>(cells[0].size());
  std::vector<std::vector<bool>> split(cells.size(), std::vector<bool>(cells[0].size()));
  const auto cell = [&](int x, int y) -> const NicholsCell& { return cells[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)]; };
  const auto mark = [&](int x, int y) { split[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] = true; };
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      if (!cell(x, y).fragment || !cell(x, y).known) continue;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const int nx = x + dx, ny = y + dy;
          if (nx < 0 || ny < 0 || nx >= columns || ny >= rows || !cell(nx, ny).known) continue;
          if (std::popcount(cell(x, y).mask ^ cell(nx, ny).mask) <= threshold) continue;
          mark(x, y);
          if (dx != 0 && dy != 0) mark(nx, y), mark(x, ny);
        }
      }
    }
  }
  return split;
}

TEST(NicholsRule, IsTheOneTold) {
  std::mt19937_64 random(11);
  for (int round = 0; round < 300; ++round) {
    Cells cells(7, std::vector<NicholsCell>(9));
    const std::uint64_t common = random();
    for (auto& row : cells) {
      for (NicholsCell& c : row) {
        // Two differ in up to ten points, so that all sorts of neighbourhoods are common.
        c.mask = common;
        for (std::uint64_t bits = random() % 6; bits > 0; --bits) c.mask ^= std::uint64_t{1} << random() % 64;
        c.known = random() % 10 != 0, c.fragment = c.known && random() % 4 != 0;
      }
    }
    const auto expected = told(cells, 6);
    for (std::size_t y = 0; y < 7; ++y) {
      for (std::size_t x = 0; x < 9; ++x) {
        if (!cells[y][x].fragment) continue;
        std::array<NicholsCell, 9> around;
        for (std::size_t i = 0; i < 9; ++i) {
          const std::size_t nx = x + i % 3 - 1, ny = y + i / 3 - 1;
          if (nx < 9 && ny < 7) around[i] = cells[ny][nx];
        }
        ASSERT_EQ(nichols_splits(around, 6), expected[y][x]) << x << ", " << y;
      }
    }
  }
}

TEST(NicholsRule, AFragmentBesideTwoThatDifferAcrossTheirCornerSplitsThoughItDiffersFromNeither) {
  std::array<NicholsCell, 9> cells;
  for (NicholsCell& c : cells) c = {0, true, true};
  // Above and left of the middle; four points away from the middle each, eight from each other.
  cells[1].mask = 0x0f, cells[3].mask = 0xf0;
  EXPECT_TRUE(nichols_splits(cells, 6));
  EXPECT_FALSE(nichols_splits(cells, 8));
  // Across the middle, they do not touch.
  cells[3].mask = 0, cells[7].mask = 0xf0;
  EXPECT_FALSE(nichols_splits(cells, 6));
  // Parts of larger fragments are only compared with.
  cells[7].mask = 0, cells[3] = {0xf0, true, false}, cells[1].fragment = false;
  EXPECT_FALSE(nichols_splits(cells, 6));
}

struct NicholsRefined {
  LightSignal signal;
  RefinementCounts counts;
};
NicholsRefined refine(Stage& stage, int threads, int channels = 3) {
  Context context;
  context.threads = threads;
  FragmentOptions options;
  options.refine = FragmentOptions::Refine::neighbours;
  NicholsRefined refined;
  refined.signal.resize(stage.g, channels);
  const LightPoints points = light_points(stage.shot.world->lights(), stage.lights[0], 64, 0);
  std::vector<std::unique_ptr<Refiner>> writers;
  for (int i = 0; i < threads; ++i) {
    writers.push_back(std::make_unique<Refiner>(*stage.shot.world, stage.view, *stage.visibility, options, 0));
    writers.back()->set_light(stage.lights[0], points);
  }
  NicholsRefiner refiner(stage.view, *stage.visibility, options, context);
  refined.counts = refiner.refine(stage.g, stage.geometry_of_all(), stage.lights[0], points, writers, refined.signal, stage.statistics);
  return refined;
}

// The whole picture once more from the definition: masks by geometry instead of rays, and level after level over all of it.
TEST(Nichols, RefinesAHalfPlanesShadowAsBruteForceDoes) {
  for (const float angle : {0.f, 0.5f}) {
    const EdgeScene edge{angle, 0.2f};
    Stage stage(edge.scene(), {300, 200});
    const GBuffer& g = stage.g;
    const LightPoints points = light_points(stage.shot.world->lights(), stage.lights[0], 64, 0);
    CentreTest test(stage.view, *stage.visibility);
    std::vector<std::uint64_t> traced;
    test.begin(0), test.set_light(stage.lights[0], points);
    const auto mask_at = [&](int x, int y, int level) {
      const int half = (1 << level) / 2;
      const Vec3 p = load(g.position, g.at(std::min(x + half, g.width - 1), std::min(y + half, g.height - 1)));
      std::uint64_t mask = 0, grazing = 0;
      for (std::size_t k = 0; k < 64; ++k) {
        const float clearance = edge.clearance(p, load(points.point, k));
        mask |= static_cast<std::uint64_t>(clearance > 0) << k;
        grazing |= static_cast<std::uint64_t>(std::fabs(clearance) < EdgeScene::kGrazing) << k;
      }
      if (grazing == 0) return mask;
      // Rays that graze the edge may do as they like.
      const Fragment f{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y), static_cast<std::uint8_t>(level)};
      test.test(g, {&f, 1}, traced, stage.statistics);
      return (mask & ~grazing) | (traced[0] & grazing);
    };
    std::vector<std::uint8_t> expected(g.kind.size());
    std::vector<IVec2> current;
    for (int y = 0; y < g.height; y += 128)
      for (int x = 0; x < g.width; x += 128) current.push_back({x, y});
    std::uint64_t asked = 0;
    for (int level = 7; level > 0; --level) {
      const int w = 1 << level, columns = (g.width + w - 1) / w, rows = (g.height + w - 1) / w;
      Cells cells(static_cast<std::size_t>(rows), std::vector<NicholsCell>(static_cast<std::size_t>(columns)));
      const auto cell = [&](int x, int y) -> NicholsCell& { return cells[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)]; };
      for (const IVec2 f : current) cell(f.x / w, f.y / w).fragment = true;
      for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) cell(x, y).mask = mask_at(x * w, y * w, level), cell(x, y).known = true;
      const auto splits = told(cells, 6);
      std::vector<IVec2> next;
      for (const IVec2 f : current) {
        const bool split = splits[static_cast<std::size_t>(f.y / w)][static_cast<std::size_t>(f.x / w)];
        for (int q = 0; q < 4 && split; ++q) {
          const IVec2 child{f.x + q % 2 * w / 2, f.y + q / 2 * w / 2};
          if (child.x < g.width && child.y < g.height) next.push_back(child);
        }
        for (int y = f.y; y < std::min(f.y + w, g.height) && !split; ++y)
          for (int x = f.x; x < std::min(f.x + w, g.width); ++x) expected[g.at(x, y)] = static_cast<std::uint8_t>(level);
      }
      // Rays: all of a fragment's neighbours are asked, whatever they are.
      for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < columns; ++x) {
          bool wanted = false;
          for (int j = std::max(y - 1, 0); j <= std::min(y + 1, rows - 1); ++j)
            for (int i = std::max(x - 1, 0); i <= std::min(x + 1, columns - 1); ++i) wanted |= cell(i, j).fragment;
          asked += wanted ? 64 : 0;
        }
      }
      current = next;
    }
    const NicholsRefined refined = refine(stage, 2);
    int pixels = 0;
    for (int y = 0; y < g.height; ++y) {
      for (int x = 0; x < g.width; ++x) {
        ASSERT_EQ(refined.signal.level[g.at(x, y)], expected[g.at(x, y)]) << x << ", " << y;
        pixels += expected[g.at(x, y)] == 0;
      }
    }
    EXPECT_GT(pixels, 200);
    EXPECT_LT(pixels, g.width * g.height / 2);
    EXPECT_EQ(refined.counts.test_rays, asked);
    EXPECT_EQ(refined.counts.finest, static_cast<std::uint64_t>(pixels));
    EXPECT_EQ(refined.counts.finest_rays, 64 * refined.counts.finest);
  }
}

TEST(Nichols, FragmentsTileTheSurfacesOnceAndOnlyThose) {
  Stage stage(box_on_floor(), {200, 150});
  const NicholsRefined refined = refine(stage, 2);
  const std::vector<Fragment> fragments = fragments_of(stage, refined.signal);
  ASSERT_FALSE(fragments.empty());
  EXPECT_EQ(refined.counts.fragments, fragments.size());
}

TEST(Nichols, IsTheSameForAnyNumberOfThreads) {
  Stage stage(box_on_floor(), {300, 150});
  for (const int channels : {1, 3}) {
    const NicholsRefined one = refine(stage, 1, channels);
    for (const int threads : {2, 4}) {
      const NicholsRefined many = refine(stage, threads, channels);
      EXPECT_EQ(one.counts.test_rays, many.counts.test_rays);
      EXPECT_TRUE(std::ranges::equal(one.signal.level, many.signal.level));
      EXPECT_TRUE(std::ranges::equal(one.signal.flags, many.signal.flags));
      for (const Fragment& f : fragments_of(stage, one.signal)) {
        for (int c = 0; c < channels; ++c) {
          const std::size_t at = stage.g.at(f.x, f.y);
          ASSERT_EQ(one.signal.value[static_cast<std::size_t>(c)][at], many.signal.value[static_cast<std::size_t>(c)][at]);
        }
      }
    }
  }
}

}  // namespace
}  // namespace sightline::test
