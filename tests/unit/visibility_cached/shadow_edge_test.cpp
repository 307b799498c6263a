// A half plane between a point light and a floor: where the cache puts the shadow's edge, and how the order of queries moves it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "cache_cases.h"

namespace sightline::test {
namespace {

const double kLevelRatio = static_cast<double>(CachedVisibilitySettings().level_ratio);

constexpr int kSize = 128;  // pixels a side
constexpr float kPixel = 0.01f;
constexpr float kSlope = 0.36f;  // the edge leans against the rows

/// Floor points of a picture seen from above, and the light; the occluder covers x < kSlope z + offset on the floor.
struct Edge {
  std::shared_ptr<const World> world;
  Vec3 light{0.11f, 2, 0.07f};
  float offset = 0;

  explicit Edge(float edge_offset) : offset(edge_offset) {
    // Half way between light and floor, far wider than the picture.
    const auto on_floor = [&](float x, float z) { return Vec3(x + kSlope * z + offset, 0, z); };
    const auto half_way = [&](const Vec3& p) { return 0.5f * (p + light); };
    const Vec3 a = half_way(on_floor(0, -9)), b = half_way(on_floor(0, 9)), c = half_way(on_floor(-20, 9)), d = half_way(on_floor(-20, -9));
    // A second, small piece far away keeps the box around the scene the same for every offset.
    const Vec3 far(30, 3, 30), low(-30, -3, -30);
    world = World::build(scene_of(make_mesh({a, b, c, d, far, far + Vec3(0.1f, 0, 0), far + Vec3(0, 0, 0.1f), low, low + Vec3(0.1f, 0, 0),
                                             low + Vec3(0, 0, 0.1f)},
                                            {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {7, 8, 9}})),
                         {}, Context());
  }
  static Vec3 point(int x, int y) {
    return {kPixel * (static_cast<float>(x) - kSize / 2 + 0.5f), 0, kPixel * (static_cast<float>(y) - kSize / 2 + 0.5f)};
  }
  bool lit(int x, int y) const {
    const Vec3 p = point(x, y);
    return p.x > kSlope * p.z + offset;
  }
  QueryBatch batch(const std::vector<int>& order) const {
    QueryBatch result;
    result.eye.resize(kSize * kSize);
    result.resize_lights(1);
    result.resize_queries(kSize * kSize);
    for (std::uint32_t i = 0; i < kSize * kSize; ++i) {
      result.eye.set(i, point(static_cast<int>(i) % kSize, static_cast<int>(i) / kSize), {0, 1, 0}, 1e-6f, kPixel * kPixel, i);
      result.eye_of[i] = static_cast<std::uint32_t>(order[i]);
      result.light_of[i] = 0;
    }
    result.light.set(0, light, Vec3(0), 0, 0, 1);
    result.semantic[0] = static_cast<std::uint8_t>(QuerySemantic::point);
    return result;
  }
};

double radical_inverse(int base, int i) {
  double result = 0, digit = 1.0 / base;
  for (; i > 0; i /= base, digit /= base) result += digit * (i % base);
  return result;
}

std::vector<int> scanline_order() {
  std::vector<int> order(kSize * kSize);
  std::iota(order.begin(), order.end(), 0);
  return order;
}

/// [Popov2013, §4.3] without the sorting within segments: every cell of a 2^7 x 3^5 grid once.
std::vector<int> halton_order() {
  std::vector<int> order;
  for (int i = 0; i < 128 * 243; ++i) {
    const int x = static_cast<int>(128 * radical_inverse(2, i)), y = static_cast<int>(std::floor(243 * radical_inverse(3, i) + 1e-9));
    if (x < kSize && y < kSize) order.push_back(y * kSize + x);
  }
  return order;
}

/// Errors of each row in pixels: positive where too much is lit.
struct EdgeError {
  double mean = 0, mean_abs = 0, worst = 0, wrong = 0;
};

EdgeError error_of(const Edge& edge, const std::vector<int>& order, const std::vector<std::string>& settings) {
  const Answers answers = Cache(edge.world, settings).ask(edge.batch(order));
  std::vector<double> rows(kSize);
  EdgeError error;
  for (int i = 0; i < kSize * kSize; ++i) {
    const int x = order[static_cast<std::size_t>(i)] % kSize, y = order[static_cast<std::size_t>(i)] / kSize;
    const double difference = answers.weights[static_cast<std::size_t>(i)] - (edge.lit(x, y) ? 1 : 0);
    rows[static_cast<std::size_t>(y)] += difference;
    error.wrong += std::fabs(difference);
  }
  for (const double row : rows) {
    error.mean += row / kSize, error.mean_abs += std::fabs(row) / kSize;
    error.worst = std::fmax(error.worst, std::fabs(row));
  }
  return error;
}

/// Means over edges at many offsets to the cells.
EdgeError over_offsets(const std::vector<int>& order, const std::vector<std::string>& settings) {
  EdgeError sum;
  constexpr int kOffsets = 12;
  for (int i = 0; i < kOffsets; ++i) {
    const EdgeError one = error_of(Edge(0.0137f * static_cast<float>(i) - 0.09f), order, settings);
    sum.mean += one.mean / kOffsets, sum.mean_abs += one.mean_abs / kOffsets, sum.wrong += one.wrong / kOffsets;
    sum.worst = std::fmax(sum.worst, one.worst);
  }
  return sum;
}

TEST(ShadowEdge, OrdersVisitEveryPixelOnce) {
  std::vector<int> order = halton_order();
  std::sort(order.begin(), order.end());
  EXPECT_EQ(order, scanline_order());
}

TEST(ShadowEdge, ExactVisibilityFindsTheAnalyticEdge) {
  const Edge edge(0.01f);
  const Answers answers = Cache(edge.world, {}, "exact").ask(edge.batch(scanline_order()));
  int wrong = 0;
  for (int i = 0; i < kSize * kSize; ++i) wrong += (answers.weights[static_cast<std::size_t>(i)] > 0.5f) != edge.lit(i % kSize, i / kSize);
  EXPECT_LE(wrong, 4);
}

TEST(ShadowEdge, LiesWithinACellOfTheTruth) {
  const EdgeError error = over_offsets(halton_order(), {"ce=8", "refine=none"});
  // Cells are at most sqrt(C_R) wider than C_E, and one that the leaning edge crosses is wrong in a row by no more than its width.
  EXPECT_LE(error.worst, 8 * std::sqrt(kLevelRatio) * (1 + kSlope) + 1);
  EXPECT_LT(std::fabs(error.mean), 0.25);
  EXPECT_GT(error.mean_abs, 0.5);  // without refinement it does show
}

TEST(ShadowEdge, RefinedLiesWithinTwoPixels) {
  const EdgeError refined = over_offsets(halton_order(), {"ce=8"});
  EXPECT_LE(refined.mean_abs, 1);
  EXPECT_LT(std::fabs(refined.mean), 0.25);
  const EdgeError coarse = over_offsets(halton_order(), {"ce=8", "refine=none"});
  EXPECT_LT(refined.wrong, 0.4 * coarse.wrong);
}

TEST(ShadowEdge, ScanlineOrderShiftsItAndHaltonDoesNot) {
  const EdgeError halton = over_offsets(halton_order(), {"ce=8", "refine=none"});
  const EdgeError scanline = over_offsets(scanline_order(), {"ce=8", "refine=none"});
  EXPECT_GT(std::fabs(scanline.mean), 4 * std::fabs(halton.mean));
  EXPECT_GT(std::fabs(scanline.mean), 0.5);
}

TEST(ShadowEdge, GrowsWithCe) {
  double last = 0;
  for (const char* ce : {"ce=2", "ce=8", "ce=24"}) {
    const EdgeError error = over_offsets(halton_order(), {ce, "refine=none"});
    EXPECT_GT(error.wrong, 1.5 * last) << ce;
    last = error.wrong;
  }
}

TEST(ShadowEdge, CountersFindMixedCells) {
  const EdgeError plain = over_offsets(halton_order(), {"ce=16"}), counted = over_offsets(halton_order(), {"ce=16", "counters=3"});
  EXPECT_LT(counted.wrong, plain.wrong);
}

TEST(ShadowEdge, AnswerOfACellIsDrawnByItsMeanVisibility) {
  // [Popov2013, Eq. 12]: over random orders the probability of 1 is the share of the cell that is lit.
  const Edge edge(0.01f);
  const Cache cache(edge.world, {"ce=1000000", "refine=none"});
  const std::unique_ptr<VisibilityWorker> worker = cache.visibility->worker();
  std::vector<int> order = scanline_order();
  std::mt19937 random(11);
  double ones = 0, lit = 0;
  for (const int i : order) lit += edge.lit(i % kSize, i / kSize);
  lit /= kSize * kSize;
  constexpr int kOrders = 256;
  QueryBatch batch = edge.batch(order);
  batch.resize_queries(16);
  for (int run = 0; run < kOrders; ++run) {
    for (std::size_t k = 0; k < 16; ++k) batch.eye_of[k] = static_cast<std::uint32_t>(random() % (kSize * kSize));
    worker->begin(static_cast<std::uint32_t>(run));
    const Answers answers = cache.ask(*worker, batch);
    ASSERT_EQ(answers.counts.traced, 1u);
    for (const float w : answers.weights) ASSERT_EQ(w, answers.weights[0]);
    ones += answers.weights[0];
  }
  EXPECT_NEAR(ones / kOrders, lit, 3 * std::sqrt(lit * (1 - lit) / kOrders));
}

}  // namespace
}  // namespace sightline::test
