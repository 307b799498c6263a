#include <gtest/gtest.h>

#include <cmath>

#include "bench/square_lights/figures.h"
#include "bench/square_lights/motion.h"
#include "bench/square_lights/sphere_maps.h"
#include "bench/square_lights/stage.h"

namespace sightline {
namespace {

SquareBenchOptions quick_options() {
  SquareBenchOptions options;
  options.quick = true;
  return options;
}

TEST(SquareStage, SmallStagesHaveALightAndAThinGround) {
  const std::optional<SquareStage> stage = load_stage("builtin:ground,content=hairball?triangles=1000", quick_options(), Context());
  ASSERT_TRUE(stage);
  ASSERT_TRUE(stage->scene.environment);
  EXPECT_NE(stage->scene.environment->image, nullptr);
  Scene scene = stage->scene;
  const std::uint64_t all = vertex_count(scene);
  const Bounds bounds = scene_bounds(scene);
  remove_ground(scene);
  EXPECT_EQ(all - vertex_count(scene), 25u * 25u);
  EXPECT_GT(vertex_count(scene), 0u);
  // Thinned out, the ground is as large as before.
  SquareBenchOptions full = quick_options();
  full.quick = false;
  const std::optional<SquareStage> whole = load_stage("builtin:ground,content=hairball?triangles=1000", full, Context());
  ASSERT_TRUE(whole);
  EXPECT_NEAR(scene_bounds(whole->scene).half_diagonal(), bounds.half_diagonal(), 1e-4f * bounds.half_diagonal());
}

TEST(SquareStage, LightsTheMethodDoesNotKnowAreLeftOutWithAWarning) {
  std::string said;
  Context context;
  context.log = [&](LogLevel level, std::string_view text) {
    if (level == LogLevel::warning) said += text;
  };
  EXPECT_FALSE(load_stage("builtin:textured", quick_options(), context));
  EXPECT_NE(said.find("left out"), std::string::npos) << said;
}

TEST(SquareStage, TheContentsMaterialIsReplacedAndTheGroundsIsNot) {
  const std::optional<SquareStage> stage = load_stage("builtin:ground,content=hairball?triangles=1000", quick_options(), Context());
  ASSERT_TRUE(stage);
  Scene scene = stage->scene;
  for (int times = 0; times < 3; ++times) set_content_material(scene, glossy_material());
  std::size_t glossy = 0;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh.index];
    const MaterialId id = instance.material_override.valid() ? instance.material_override : mesh.material_of(0);
    ASSERT_TRUE(id.valid());
    const bool is_phong = std::holds_alternative<PhongMaterial>(scene.materials[id.index].model);
    EXPECT_EQ(is_phong, mesh.name != "ground");
    glossy += is_phong;
  }
  EXPECT_GT(glossy, 0u);
  EXPECT_LE(scene.materials.size(), stage->scene.materials.size() + 2);
}

TEST(SquareStage, CountsWhatHangsOnAnAnimatedNode) {
  const std::optional<SquareStage> still = load_stage("builtin:ground,content=hairball?triangles=1000", quick_options(), Context());
  EXPECT_EQ(moving_part_count(still->scene), 0);
  const std::optional<SquareStage> pair = load_stage("builtin:pair", quick_options(), Context());
  ASSERT_TRUE(pair);
  EXPECT_EQ(moving_part_count(pair->scene), 2);
}

TEST(SquareMotion, AnOrbitKeepsItsDistanceAndLooksAtTheSamePoint) {
  Camera camera;
  camera.world_from_camera = Mat4(1);
  camera.world_from_camera[3] = Vec4(1, 2, 8, 1);
  const Vec3 center(1, 0, 3);
  const Camera moved = orbited(camera, center, 0.7f);
  const Vec3 eye(moved.world_from_camera[3]);
  EXPECT_NEAR(glm::length(eye - center), glm::length(Vec3(1, 2, 8) - center), 1e-5f);
  const Vec3 seen(glm::inverse(moved.world_from_camera) * Vec4(center, 1)),
      before(glm::inverse(camera.world_from_camera) * Vec4(center, 1));
  EXPECT_NEAR(glm::length(seen - before), 0, 1e-5f);
}

// Squares and regions are drawn from the same tree: the mean of the squares over the sphere is that of the light.
TEST(SquareMaps, SquaresKeepTheLight) {
  const Context context;
  const square_lights::LightCube cube = square_lights::make_light_cube(
      [](const Vec3& d) { return Color(d.y > 0.9f ? 20.f : 0.f) + Color(0.5f + 0.3f * d.x, 0.4f, 0.2f); }, 8, 4, context);
  const square_lights::MergeTree tree = square_lights::MergeTree::build(cube, {}, context);
  const auto mean = [](const ColorImage& image) {
    double sum = 0, weights = 0;
    for (int y = 0; y < image.height; ++y) {
      const double weight = std::sin(3.14159265 * (y + 0.5) / image.height);
      for (int x = 0; x < image.width; ++x) sum += weight * static_cast<double>(image.at(x, y).y), weights += weight;
    }
    return sum / weights;
  };
  const double truth = mean(cube_picture(cube));
  EXPECT_NEAR(mean(square_picture(tree, 30)), truth, 0.03 * truth);
  const ColorImage regions = region_picture(cube, tree, 6);
  EXPECT_GT(mean(regions), 0);
}

TEST(SquareFigures, ViewsWithoutFiguresOfTheirOwnHaveAll) {
  for (const std::string& view : figure_views()) {
    const FigureSet figures = figures_of(view);
    EXPECT_TRUE(figures.counts || figures.motion || figures.deforming) << view;
  }
  const FigureSet all = figures_of("builtin:anything");
  EXPECT_TRUE(all.lights && all.counts && all.motion && all.materials && all.local_light && all.deforming);
}

}  // namespace
}  // namespace sightline
