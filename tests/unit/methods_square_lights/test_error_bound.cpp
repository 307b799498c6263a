#include "methods/square_lights/error_bound.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <vector>

namespace sightline::square_lights {
namespace {

constexpr std::size_t kCount = 24;
using Function = std::vector<float>;

/// Functions of many kinds: smooth, spiky, signed, binary, constant.
Function random_function(std::mt19937& random) {
  std::uniform_real_distribution<float> unit(0, 1);
  Function f(kCount);
  const float scale = std::exp(4 * unit(random) - 2), offset = 3 * unit(random) - 1.5f;
  const int kind = static_cast<int>(5 * unit(random));
  for (std::size_t i = 0; i < kCount; ++i) {
    const float u = unit(random);
    if (kind == 0) f[i] = scale * u;
    if (kind == 1) f[i] = u < 0.1f ? 20 * scale : 0.1f * scale;
    if (kind == 2) f[i] = scale * (2 * u - 1) + offset;
    if (kind == 3) f[i] = u < 0.4f ? 1.f : 0.f;
    if (kind == 4) f[i] = (i % 2 != 0 ? 1.f : -1.f) * scale;
  }
  return f;
}

double mean(const Function& a, const Function& b, const Function& c) {
  double sum = 0;
  for (std::size_t i = 0; i < kCount; ++i) sum += static_cast<double>(a[i]) * b[i] * c[i];
  return sum / kCount;
}

TEST(ErrorBound, IsNeverExceeded) {
  std::mt19937 random(1);
  double tightest = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const Function f = random_function(random), g = random_function(random), h = random_function(random);
    const Moments a = moments_of(f), b = moments_of(g), c = moments_of(h);
    const double error = std::fabs(mean(f, g, h) - static_cast<double>(a.mean) * b.mean * c.mean), bound = product_bound(a, b, c);
    EXPECT_LE(error, bound * (1 + 1e-4) + 1e-6);
    if (bound > 0) tightest = std::max(tightest, error / bound);
  }
  EXPECT_GT(tightest, 0.6);  // and it is not far too large either
}

TEST(ErrorBound, NeedsAbsoluteThirdMoments) {
  // Three equal functions, each two parts of 1 and one of -2 about a mean of 0, so that only the term of the third moments is left. Mixed
  // with its mirror image, which makes the signed third moment vanish, the product's mean does not.
  Function f(kCount), g(kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    f[i] = i % 2 != 0 ? 1.f : -1.f;
    g[i] = i % 4 < 2 ? 1.f : -1.f;
  }
  Function h(kCount);
  for (std::size_t i = 0; i < kCount; ++i) h[i] = f[i] * g[i];
  const Moments a = moments_of(f), b = moments_of(g), c = moments_of(h);
  EXPECT_NEAR(a.mean, 0, 1e-6f);
  EXPECT_NEAR(mean(f, g, h), 1, 1e-6);  // signed third moments are all 0 and would have it 0
  EXPECT_NEAR(product_bound(a, b, c), 1, 1e-5);
}

TEST(ErrorBound, HoldsForBinaryVisibilityWithoutThirdMoments) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> unit(0, 1);
  for (int trial = 0; trial < 10000; ++trial) {
    const Function f = random_function(random), g = random_function(random);
    Function v(kCount);
    const float share = unit(random);
    float visible = 0;
    for (float& x : v) visible += x = unit(random) < share ? 1.f : 0.f;
    const Moments a = moments_of(f), b = moments_of(g), c = binary_moments(visible / kCount);
    const Moments direct = moments_of(v);
    EXPECT_NEAR(c.deviation, direct.deviation, 1e-4f);
    EXPECT_NEAR(c.third, direct.third, 1e-4f);
    const double error = std::fabs(mean(f, g, v) - static_cast<double>(a.mean) * b.mean * c.mean);
    EXPECT_LE(error, product_bound_binary(a, b, c) * (1 + 1e-4) + 1e-6);
  }
}

/// A small environment and a receiver whose BRDF and visibility change across the sphere.
class Refining : public testing::Test {
 protected:
  Refining() {
    const Context context;
    cube_ = make_light_cube([](const Vec3& d) { return Color(1.1f + d.x + (d.y > 0.9f ? 50.f : 0.f)); }, 8, 2, context);
    tree_ = MergeTree::build(cube_, {}, context);
  }
  /// Half of everything is visible, by halves of the sphere; the BRDF varies a lot over large nodes.
  void evaluate(std::span<const std::int32_t> nodes, std::span<NodeTerm> terms) {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const MergeNode& node = tree_.nodes()[static_cast<std::size_t>(nodes[i])];
      const float r = node.light.radius;
      terms[i] = node_term(node, std::clamp(0.5f + node.light.center.z / (2 * r), 0.f, 1.f), {0.3f, 0.3f * std::min(r, 1.f), 0});
      asked_ += 1;
    }
  }
  std::vector<std::int32_t> refine(float part, std::size_t most, std::size_t start = 10) {
    asked_ = 0;
    const auto result = refiner_.refine(tree_, tree_.cut(start), part, most, [this](auto nodes, auto terms) { evaluate(nodes, terms); });
    return {result.begin(), result.end()};
  }
  /// Whether every texel belongs to exactly one of the nodes.
  bool is_cut(const std::vector<std::int32_t>& nodes) const {
    std::multiset<std::int32_t> texels;
    std::vector<std::int32_t> open = nodes;
    while (!open.empty()) {
      const MergeNode& node = tree_.nodes()[static_cast<std::size_t>(open.back())];
      if (node.left < 0) texels.insert(open.back());
      open.pop_back();
      if (node.left >= 0) open.push_back(node.left), open.push_back(node.right);
    }
    return texels.size() == cube_.count() && std::set(texels.begin(), texels.end()).size() == cube_.count();
  }

  LightCube cube_;
  MergeTree tree_;
  CutRefiner refiner_;
  std::size_t asked_ = 0;
};

TEST_F(Refining, GivesCutsWhoseBoundsAreBelowTheLimit) {
  std::size_t before = 10;
  for (const float part : {0.1f, 0.03f, 0.01f}) {
    const std::vector<std::int32_t> nodes = refine(part, 100000);
    EXPECT_TRUE(is_cut(nodes));
    EXPECT_GE(nodes.size(), before);
    before = nodes.size();
    std::vector<NodeTerm> terms(nodes.size());
    evaluate(nodes, terms);
    double total = 0;
    for (const NodeTerm& term : terms) total += term.value;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const bool texel = tree_.nodes()[static_cast<std::size_t>(nodes[i])].left < 0;
      // Totals change a little while nodes are split.
      EXPECT_TRUE(texel || terms[i].bound <= 1.3 * part * total) << "part " << part;
    }
  }
  EXPECT_GT(before, 20u);
}

TEST_F(Refining, LeavesCutsThatAreGoodEnoughOrMayNotGrow) {
  EXPECT_EQ(refine(1e6f, 1000).size(), 10u);
  EXPECT_EQ(asked_, 10u);
  EXPECT_EQ(refine(0, 100000).size() > 300, true);
  for (const std::size_t most : {10u, 11u, 17u, 40u}) {
    const std::vector<std::int32_t> nodes = refine(1e-4f, most);
    EXPECT_EQ(nodes.size(), most);
    EXPECT_TRUE(is_cut(nodes));
  }
}

TEST_F(Refining, KeepsTheCutOfADarkReceiver) {
  const std::vector<std::int32_t> cut = tree_.cut(12);
  const auto result = refiner_.refine(tree_, cut, 0.01f, 1000, [](auto, auto terms) {
    for (NodeTerm& term : terms) term = {0, 1};
  });
  EXPECT_EQ(result.size(), cut.size());
}

}  // namespace
}  // namespace sightline::square_lights
