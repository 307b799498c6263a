// Anti-aliasing of geometric edges.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "methods/fragments/edges.h"
#include "test_fragments_support.h"

namespace sightline::test {
namespace {

constexpr IVec2 kSize{150, 101};

Picture taken(const Shot& shot, std::vector<std::string> settings, int threads = 2) {
  return expose(shot, {.method = "fragments", .settings = std::move(settings), .spp = 1, .max_bounces = 0, .threads = threads});
}
/// Elements of the GBuffer, sorted.
std::vector<std::uint32_t> edges_of(const Stage& stage) {
  std::vector<std::uint32_t> edges;
  for (std::size_t root = 0; root < stage.g.root_count(); ++root)
    edge_pixels(stage.g, stage.g.root(root), {.tau_n = 0.2f, .tau_d = 0.001f}, edges);
  std::ranges::sort(edges);
  return edges;
}
/// Over the pixels on edges; what is brighter than white is white.
double edge_error(const Stage& stage, const Frame& frame, const Frame& truth) {
  double sum = 0;
  const std::vector<std::uint32_t> edges = edges_of(stage);
  const auto stride = static_cast<std::uint32_t>(stage.g.stride), width = static_cast<std::uint32_t>(stage.g.width);
  for (const std::uint32_t at : edges) {
    const std::uint32_t pixel = at / stride * width + at % stride;
    const Vec3 difference = glm::min(frame.color(pixel), Color(1)) - glm::min(truth.color(pixel), Color(1));
    sum += glm::dot(difference, difference);
  }
  return sum / static_cast<double>(edges.size());
}
Frame area_average(const Shot& shot) {
  return expose(shot, {.method = "reference", .spp = 64, .light_samples = 16, .max_bounces = 0, .filter = PixelFilter::Kind::box}).frame;
}
/// Two lights, a glossy box, a mirror and a lamp in sight.
Scene mixed() {
  Scene scene = box_on_floor();
  scene.materials[1].model = MetallicRoughnessMaterial{.base_color = Color(0.7f, 0.4f, 0.3f), .metallic = 0.3f, .roughness = 0.4f};
  place(scene, box_mesh({0.9f, 0, -1}, {1.2f, 0.7f, 0}), add_material(scene, MetallicRoughnessMaterial{.metallic = 1, .roughness = 0}));
  const MaterialId glowing = add_material(scene, DiffuseMaterial{.reflectance = Color(0)}, Color(2, 1.5f, 1));
  place(scene, make_mesh({{-0.9f, 0.4f, 0.8f}, {-0.5f, 0.4f, 1.2f}, {-0.9f, 0.9f, 0.9f}}, {{0, 1, 2}}), glowing);
  return scene;
}

TEST(EdgeSamples, BringEdgesCloserToTheMeanOverEachPixel) {
  Scene spheres = builtin_scene("spheres");
  spheres.environment.reset();
  spheres.lights = {{.name = "lamp", .shape = lamp({0.5f, 5, 2}, 0.6f, Color(20)), .node = {}}};
  for (const Scene& scene : {box_on_floor(), mixed(), spheres}) {
    const Shot shot = shot_of(scene, kSize);
    const Stage stage(scene, kSize);
    const Frame truth = area_average(shot);
    for (const char* variant : {"variant=sightline", "variant=koa", "variant=nichols"}) {
      const double one = edge_error(stage, taken(shot, {variant}).frame, truth);
      const double four = edge_error(stage, taken(shot, {variant, "edge_samples=4"}).frame, truth);
      const double sixteen = edge_error(stage, taken(shot, {variant, "edge_samples=16"}).frame, truth);
      // The predecessor errs by more than edges do.
      EXPECT_LT(four, (variant[8] == 'n' ? 0.8 : 0.6) * one) << variant;
      EXPECT_LT(sixteen, (variant[8] == 'n' ? 1.0 : 0.6) * four) << variant;
    }
  }
}

TEST(EdgeSamples, LeaveAllButEdgesAlone) {
  const Shot shot = shot_of(mixed(), kSize);
  const Picture plain = taken(shot, {}), smooth = taken(shot, {"edge_samples=5"});
  Stage stage(mixed(), kSize);
  const std::vector<std::uint32_t> edges = edges_of(stage);
  std::size_t changed = 0;
  for (int y = 0; y < kSize.y; ++y) {
    for (int x = 0; x < kSize.x; ++x) {
      const auto pixel = static_cast<std::uint32_t>(y * kSize.x + x);
      const bool same = plain.frame.color(pixel) == smooth.frame.color(pixel);
      if (!std::ranges::binary_search(edges, static_cast<std::uint32_t>(stage.g.at(x, y)))) {
        EXPECT_TRUE(same) << x << ", " << y;
      }
      changed += !same;
    }
  }
  EXPECT_GT(changed, edges.size() / 4);
  EXPECT_EQ(smooth.statistics.method_statistics.at("edge_points"), 4.0 * static_cast<double>(edges.size()));
  // Few points show a surface that no pixel around them shows.
  const auto tests = smooth.statistics.method_statistics.find("edge_tests");
  if (tests != smooth.statistics.method_statistics.end()) {
    EXPECT_LT(tests->second, 0.2 * 4 * static_cast<double>(edges.size()));
  }
}

TEST(EdgeSamples, AreTheSameForAnyNumberOfThreads) {
  const Shot shot = shot_of(mixed(), {300, 140});
  const Picture one = taken(shot, {"edge_samples=16"}, 1);
  for (const int threads : {2, 4}) EXPECT_TRUE(same_sums(one.frame, taken(shot, {"edge_samples=16"}, threads).frame)) << threads;
}

TEST(EdgeSamples, MayComeWithAnythingElse) {
  Scene scene = mixed();
  for (const IVec2 size : {IVec2(1, 1), IVec2(129, 3)}) {
    for (const char* setting : {"refine=all", "refine=nichols", "upsample=multipass", "signal=irradiance"}) {
      const Picture picture = taken(shot_of(scene, size), {setting, "edge_samples=3"});
      EXPECT_EQ(picture.frame.nonfinite_samples(), 0u) << setting;
      EXPECT_EQ(picture.frame.samples_done(), 1u) << setting;
    }
  }
  scene.lights.clear();
  EXPECT_EQ(taken(shot_of(bare_floor(Occluder::none), {40, 30}), {"edge_samples=3"}).frame.nonfinite_samples(), 0u);
}

TEST(Edges, AreSeenFromBothSides) {
  Stage stage(box_on_floor(), kSize);
  const std::vector<std::uint32_t> edges = edges_of(stage);
  EXPECT_EQ(std::ranges::adjacent_find(edges), edges.end());
  // Box and floor differ in their normals or, where the top hides the floor, in depth.
  const auto on_box = [&](int x, int y) { return stage.g.albedo.y[stage.g.at(x, y)] > 0.55f; };
  std::vector<std::uint32_t> expected;
  for (int y = 0; y < kSize.y; ++y) {
    for (int x = 0; x < kSize.x; ++x) {
      const auto across = [&](int nx, int ny) {
        return stage.g.inside(nx, ny) && stage.interpolable(x, y) && stage.interpolable(nx, ny) && on_box(x, y) != on_box(nx, ny);
      };
      if (across(x - 1, y) || across(x + 1, y) || across(x, y - 1) || across(x, y + 1))
        expected.push_back(static_cast<std::uint32_t>(stage.g.at(x, y)));
    }
  }
  EXPECT_GT(expected.size(), 100u);
  EXPECT_TRUE(std::ranges::includes(edges, expected));
}

}  // namespace
}  // namespace sightline::test
