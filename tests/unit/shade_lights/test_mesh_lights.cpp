#include <gtest/gtest.h>

#include <cmath>

#include "light_test_scene.h"
#include "support/chi_square.h"
#include "trace/ray_batch.h"

namespace sightline {
namespace {

using test::emissive;
using test::irradiance;
using test::table_of;

const std::vector<Vec3> kCorners{{-0.5f, 1, -1}, {1, 1, 0.2f}, {-0.7f, 1, 1}};
MaterialId material(std::size_t i) { return MaterialId(i); }

TEST(MeshLights, ReflectionKeepsTheFrontSideOfTheObject) {
  // The object emits downwards in its own space. Mirrored in x it still emits downwards, mirrored in y upwards.
  const auto scene = [&](const Vec3& scale) {
    return test::scene_with_mesh(kCorners, {{0, 1, 2}}, emissive(Color(1)),
                                 Mat4(Mat3(Vec3(scale.x, 0, 0), Vec3(0, scale.y, 0), Vec3(0, 0, scale.z))));
  };
  ASSERT_LT(glm::cross(kCorners[1] - kCorners[0], kCorners[2] - kCorners[0]).y, 0);
  EXPECT_GT(irradiance(table_of(scene({1, 1, 1})), Vec3(0), {0, 1, 0}, 32).x, 0.1f);
  EXPECT_GT(irradiance(table_of(scene({-1, 1, 1})), Vec3(0), {0, 1, 0}, 32).x, 0.1f);
  EXPECT_EQ(irradiance(table_of(scene({1, -1, 1})), Vec3(0), {0, -1, 0}, 32).x > 0.1f, true);
  EXPECT_EQ(irradiance(table_of(scene({1, -1, 1})), {0, -5, 0}, {0, 1, 0}, 32).x, 0);
}

TEST(MeshLights, LightOfFindsTrianglesOfPalettesOverridesAndInstances) {
  Scene scene = test::scene_with_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1.1f, 1, 0}}, {{0, 1, 2}, {1, 3, 2}, {0, 1, 3}}, Material{});
  scene.materials.push_back(emissive(Color(2)));
  scene.materials.push_back(emissive(Color(5)));
  scene.materials.push_back(emissive(Color(NAN, 1, 1)));
  Mesh& mesh = scene.meshes[0];
  mesh.materials = {material(0), material(1), material(2)};
  mesh.triangle_materials = SharedArray<std::uint16_t>(std::vector<std::uint16_t>{2, 0, 1});
  scene.instances.push_back(scene.instances[0]);  // 1: the same again
  scene.instances.push_back(scene.instances[0]);  // 2: everything replaced by an emitter
  scene.instances[2].material_override = material(1);
  scene.instances.push_back(scene.instances[0]);  // 3: everything replaced by a dark material
  scene.instances[3].material_override = material(0);
  scene.instances.push_back(scene.instances[0]);  // 4: by one whose emission is not a number
  scene.instances[4].material_override = material(3);
  Sphere sphere;
  sphere.material = material(2);
  scene.spheres = {Sphere{}, sphere};
  const LightTable table = table_of(scene);
  ASSERT_EQ(table.size(), 2u + 2 + 3 + 1);
  const auto radiance = [&](std::uint32_t instance, std::uint32_t primitive) {
    const std::uint32_t light = table.light_of(instance, primitive);
    return light == kNoLight ? 0.f : table.emission(light, {}, true).x;
  };
  for (const std::uint32_t i : {0u, 1u}) {
    EXPECT_EQ(radiance(i, 0), 5);
    EXPECT_EQ(radiance(i, 1), 0);
    EXPECT_EQ(radiance(i, 2), 2);
  }
  for (const std::uint32_t p : {0u, 1u, 2u}) {
    EXPECT_EQ(radiance(2, p), 2);
    EXPECT_EQ(radiance(3, p), 0);
    EXPECT_EQ(radiance(4, p), 0);
  }
  EXPECT_EQ(radiance(0, 3), 0);
  EXPECT_EQ(radiance(77, 0), 0);
  EXPECT_EQ(radiance(kNoHit, 0), 0);
  EXPECT_EQ(radiance(kSphereBit | 0, 0), 0);
  EXPECT_EQ(radiance(kSphereBit | 1, 0), 5);
  EXPECT_EQ(radiance(kSphereBit | 2, 0), 0);
  EXPECT_NE(table.light_of(0, 0), table.light_of(1, 0));
  EXPECT_EQ(table.emission(table.light_of(0, 0), {}, false).x, 0);
}

TEST(MeshLights, TwoTrianglesThatMakeAParallelogramAreOneLight) {
  const std::vector<Vec3> square{{-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1}};
  const LightTable table = table_of(test::scene_with_mesh(square, {{0, 1, 2}, {0, 2, 3}}, emissive(Color(3))));
  ASSERT_EQ(table.size(), 1u);
  EXPECT_EQ(table.light_of(0, 0), 0u);
  EXPECT_EQ(table.light_of(0, 1), 0u);
  EXPECT_EQ(table.light_of(0, 2), kNoLight);
  EXPECT_FLOAT_EQ(table.power(0), 3 * 4 * kPi);
  // Every point of the square is drawn with the density that a hit would be given, and on the side that the winding says.
  for (int i = 0; i < 64; ++i) {
    const Vec2 u{static_cast<float>(i % 8) / 8, static_cast<float>(i / 8) / 8};
    const LightSample s = table.sample({0.3f, 0, 0.1f}, {0, 1, 0}, 0.5f, u);
    EXPECT_TRUE(std::fabs(s.point.x) <= 1 && std::fabs(s.point.z) <= 1 && s.point.y == 2);
    EXPECT_GT(s.pdf, 0);
    EXPECT_NEAR(s.pdf, table.pdf({0.3f, 0, 0.1f}, {0, 1, 0}, 0, s.point, s.normal, s.wi), 1e-4f * s.pdf);
  }
}

TEST(MeshLights, OnlyUntexturedParallelogramsOfOneMaterialAreMerged) {
  const std::vector<Vec3> square{{-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1}};
  const auto size_with = [&](std::vector<Vec3> corners, const std::vector<UVec3>& triangles) {
    return table_of(test::scene_with_mesh(corners, triangles, emissive(Color(3)))).size();
  };
  std::vector<Vec3> bent = square, trapezium = square;
  bent[3].y = 2.01f, trapezium[3].x = -1.01f;
  EXPECT_EQ(size_with(bent, {{0, 1, 2}, {0, 2, 3}}), 2u);
  EXPECT_EQ(size_with(trapezium, {{0, 1, 2}, {0, 2, 3}}), 2u);
  EXPECT_EQ(size_with(square, {{0, 1, 2}, {0, 3, 2}}), 2u) << "one faces up, one down";
  EXPECT_EQ(size_with(square, {{2, 0, 1}, {3, 0, 2}}), 1u) << "whatever corner a triangle begins with";
  EXPECT_EQ(size_with(square, {{0, 1, 2}, {0, 2, 3}, {0, 1, 2}}), 2u);
}

TEST(MeshLights, InterfacesDoNotEmit) {
  Material m = emissive(Color(1));
  m.model = InterfaceMaterial{};
  EXPECT_EQ(table_of(test::scene_with_mesh(kCorners, {{0, 1, 2}}, m)).size(), 0u);
}

TEST(MeshLights, PowerIsRadianceTimesAreaTimesPi) {
  const float area = 0.5f * glm::length(glm::cross(kCorners[1] - kCorners[0], kCorners[2] - kCorners[0]));
  const Mat4 twice(Mat3(2.f));
  EXPECT_NEAR(table_of(test::scene_with_mesh(kCorners, {{0, 1, 2}}, emissive(Color(3)))).power(0), 3 * kPi * area, 1e-4f);
  EXPECT_NEAR(table_of(test::scene_with_mesh(kCorners, {{0, 1, 2}}, emissive(Color(3), true))).power(0), 6 * kPi * area, 1e-4f);
  EXPECT_NEAR(table_of(test::scene_with_mesh(kCorners, {{0, 1, 2}}, emissive(Color(3)), twice)).power(0), 12 * kPi * area, 1e-3f);
}

TEST(MeshLights, ChoiceIsByPowerAndProbabilitiesSumToOne) {
  std::vector<Vec3> positions;
  std::vector<UVec3> triangles;
  test::Uniform random(8);
  for (std::uint32_t i = 0; i < 50; ++i) {
    for (int k = 0; k < 3; ++k) positions.push_back(Vec3(random.next(), 1 + random.next(), random.next()) * (i == 7 ? 0.f : 1.f));
    triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const LightTable table = table_of(test::scene_with_mesh(positions, triangles, emissive(Color(1), true)));
  ASSERT_EQ(table.size(), 50u);
  EXPECT_EQ(table.power(7), 0);
  double power = 0;
  for (std::uint32_t i = 0; i < 50; ++i) power += table.power(i);
  std::vector<double> observed(50), expected(50);
  constexpr int count = 100000;
  for (int i = 0; i < count; ++i) ++observed[table.sample(Vec3(0), Vec3(0), random.next(), random.next2()).light];
  for (std::uint32_t i = 0; i < 50; ++i) expected[i] = count * table.power(i) / power;
  const auto result = test::chi_square(observed, expected);
  EXPECT_GT(result.p_value, 1e-4) << result.table;
}

TEST(MeshLights, TexturedEmissionIsReadAtThePoint) {
  // The left half of the texture is dark. Irradiance equals that of the bright half alone.
  Scene scene = test::scene_with_mesh({{-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}}, {{0, 1, 2}, {0, 2, 3}}, emissive(Color(2)));
  scene.meshes[0].uvs = SharedArray<Vec2>(std::vector<Vec2>{{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  scene.images.push_back({"half", std::make_shared<const Image>(Image{2, 1, 1, Image::Floats{0, 1}})});
  ImageTexture node;
  node.image = ImageId(std::size_t{0});
  node.filter = TextureFilter::nearest;
  scene.textures.push_back({"half", node});
  scene.materials[0].emission.texture = TextureId(std::size_t{0});
  const LightTable table = table_of(scene);
  ASSERT_EQ(table.size(), 2u);
  const double truth = 2 * test::polygon_irradiance({{0, 1, -1}, {1, 1, -1}, {1, 1, 1}, {0, 1, 1}}, Vec3(0), {0, 1, 0});
  EXPECT_NEAR(irradiance(table, Vec3(0), {0, 1, 0}, 1024).x, truth, 5e-3 * truth);
  // The emission of a hit agrees with the radiance of a sample.
  test::Uniform random(14);
  for (int i = 0; i < 100; ++i) {
    const LightSample s = table.sample(Vec3(0), Vec3(0), random.next(), random.next2());
    const Vec2 uv{0.5f * (s.point.x + 1), 0.5f * (s.point.z + 1)};
    EXPECT_EQ(s.radiance, table.emission(s.light, {.uv = uv}, true)) << uv.x;
  }
  EXPECT_NEAR(table.power(0) + table.power(1), 2 * 0.5f * 4 * kPi, 2);
}

TEST(MeshLights, StreamedMeshesThatEmitAreReported) {
  struct NoSource final : MeshSource {
    std::uint64_t vertex_count() const override { return 3; }
    std::uint64_t triangle_count() const override { return 1; }
    Bounds bounds() const override { return {}; }
    void restart() override {}
    bool next(MeshChunk&) override { return false; }
  };
  Scene scene = test::scene_with_mesh(kCorners, {{0, 1, 2}}, emissive(Color(1)));
  scene.meshes[0].source = std::make_shared<NoSource>();
  Context context;
  int warnings = 0;
  context.log = [&](LogLevel, std::string_view) { ++warnings; };
  EXPECT_EQ(LightTable(scene, TextureSet(), Bounds(), context).size(), 0u);
  EXPECT_EQ(warnings, 1);
}

}  // namespace
}  // namespace sightline
