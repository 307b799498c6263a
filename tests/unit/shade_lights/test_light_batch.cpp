// Batches give bit for bit what single calls give.
#include <gtest/gtest.h>

#include <hwy/targets.h>

#include <array>
#include <bit>
#include <cmath>

#include "light_test_scene.h"
#include "support/chi_square.h"
#include "support/every_target.h"

namespace sightline {
namespace {

using test::scene_with;
using test::table_of;

void expect_same_bits(float a, float b, const char* what, std::size_t lane) {
  EXPECT_EQ(std::bit_cast<std::uint32_t>(a), std::bit_cast<std::uint32_t>(b)) << what << " of lane " << lane << ": " << a << " " << b;
}

void check_lanes(const LightTable& table);

/// On every instruction set that this machine has.
void check_batch(const LightTable& table, const char* name) {
  SCOPED_TRACE(name);
  test::on_every_target([&] { check_lanes(table); });
}

void check_lanes(const LightTable& table) {
  test::Uniform random(77);
  for (const std::size_t count : {1u, 16u, 37u, 1000u}) {
    Vec3Batch position, normal;
    position.resize(count);
    normal.resize(count);
    std::vector<float> u_pick(count), u0(count), u1(count);
    for (std::size_t i = 0; i < count; ++i) {
      position.x[i] = 6 * random.next() - 3;
      position.y[i] = 6 * random.next() - 3;
      position.z[i] = i % 11 == 0 ? 0.f : 6 * random.next() - 3;
      u_pick[i] = random.next();
      u0[i] = random.next();
      u1[i] = random.next();
      if (i % 13 == 5) {  // on the very light point
        const LightSample s = table.sample(Vec3(0), Vec3(0), u_pick[i], {u0[i], u1[i]});
        position.x[i] = s.point.x;
        position.y[i] = s.point.y;
        position.z[i] = s.point.z;
      }
    }
    LightSampleBatch batch;
    table.sample(position, normal, u_pick, u0, u1, count, batch);
    ASSERT_GE(batch.pdf.size(), count);
    for (std::size_t i = 0; i < count; ++i) {
      const LightSample s = table.sample({position.x[i], position.y[i], position.z[i]}, Vec3(0), u_pick[i], {u0[i], u1[i]});
      expect_same_bits(batch.pdf[i], s.pdf, "pdf", i);
      expect_same_bits(batch.distance[i], s.distance, "distance", i);
      expect_same_bits(batch.point_error[i], s.point_error, "point_error", i);
      EXPECT_EQ(batch.light[i], s.light);
      EXPECT_EQ(batch.is_delta[i] != 0, s.is_delta);
      EXPECT_EQ(batch.is_mesh[i] != 0, s.is_mesh);
      const auto same = [&](const Vec3Batch& b, const Vec3& v, const char* what) {
        expect_same_bits(b.x[i], v.x, what, i);
        expect_same_bits(b.y[i], v.y, what, i);
        expect_same_bits(b.z[i], v.z, what, i);
      };
      same(batch.wi, s.wi, "wi");
      same(batch.point, s.point, "point");
      same(batch.normal, s.normal, "normal");
      same(batch.radiance, s.radiance, "radiance");
      if (testing::Test::HasFailure()) return;
    }
    for (std::uint32_t kinds = 1; kinds < 8; ++kinds) {
      const LightSubset subset = table.subset(kinds);
      table.sample(subset, position, normal, u_pick, u0, u1, count, batch);
      for (std::size_t i = 0; i < count; ++i) {
        if (subset.empty()) {
          EXPECT_EQ(batch.pdf[i], 0);
          continue;
        }
        const std::uint32_t light = subset.entries.size() == 1 ? subset.entries[0] : subset.choice.sample(u_pick[i]).index;
        const LightSample s =
            table.sample_light(light, subset.choice.probability(light), {position.x[i], position.y[i], position.z[i]}, {u0[i], u1[i]});
        expect_same_bits(batch.pdf[i], s.pdf, "pdf in a subset", i);
        EXPECT_EQ(batch.light[i], light);
        if (testing::Test::HasFailure()) return;
      }
    }
  }
}

Scene triangles(std::size_t count, bool two_sided) {
  std::vector<Vec3> positions;
  std::vector<UVec3> indices;
  test::Uniform random(5);
  for (std::uint32_t i = 0; i < count; ++i) {
    for (int k = 0; k < 3; ++k) positions.push_back(2.f * Vec3(random.next(), random.next(), random.next()) - 1.f);
    indices.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return test::scene_with_mesh(positions, indices, test::emissive(Color(1, 2, 3), two_sided));
}

const RectangleLight kRectangle{{0.3f, 1, 0}, {1, 0.1f, 0}, {0, 0.2f, 0.7f}, Color(3, 2, 1)};

TEST(LightBatch, EachKindAloneEqualsTheScalarDefinition) {
  check_batch(table_of(scene_with(kRectangle)), "rectangle");
  check_batch(table_of(scene_with(DiskLight{{0.3f, 1, 0}, {1, 0.1f, 0}, {0, 0.2f, 0.7f}, Color(3, 2, 1)})), "disk");
  check_batch(table_of(scene_with(SphereLight{{0.3f, 1, 0}, 0.7f, Color(3, 2, 1)})), "sphere");
  check_batch(table_of(scene_with(PointLight{{0.3f, 1, 0}, Color(3, 2, 1)})), "point");
  check_batch(table_of(scene_with(DirectionalLight{glm::normalize(Vec3(1, -2, 0.3f)), Color(3, 2, 1)})), "directional");
  check_batch(table_of(scene_with(SpotLight{.position = {0, 2, 0}, .direction = {0, -1, 0}})), "spot");
  check_batch(table_of(triangles(1, false)), "triangle");
  check_batch(table_of(triangles(1, true)), "two-sided triangle");
  Scene sky;
  sky.environment = Environment{};
  check_batch(table_of(sky), "environment");
  check_batch(table_of(Scene{}), "none");
}

TEST(LightBatch, ManyOfAKindEqualTheScalarDefinition) {
  check_batch(table_of(triangles(200, false)), "triangles");
  check_batch(table_of(triangles(200, true)), "two-sided triangles");
  Scene points, rectangles, suns;
  for (int i = 0; i < 7; ++i) {
    const auto f = static_cast<float>(i);
    points.lights.push_back({"p", PointLight{{f, 1, 0}, Color(1 + f)}, {}});
    suns.lights.push_back({"d", DirectionalLight{{f, -1, 0}, Color(1 + f)}, {}});
    RectangleLight r = kRectangle;
    r.center.x += f;
    rectangles.lights.push_back({"r", r, {}});
  }
  check_batch(table_of(points), "points");
  check_batch(table_of(rectangles), "rectangles");
  check_batch(table_of(suns), "directional lights");
}

TEST(LightBatch, MixturesEqualTheScalarDefinition) {
  Scene scene = triangles(20, false);
  scene.environment = Environment{};
  scene.lights.push_back({"r", kRectangle, {}});
  scene.lights.push_back({"d", DiskLight{{0.3f, 1, 0}, {1, 0.1f, 0}, {0, 0.2f, 0.7f}, Color(3, 2, 1)}, {}});
  scene.lights.push_back({"p", PointLight{{1, 1, 0}, Color(2)}, {}});
  scene.lights.push_back({"s", SpotLight{.position = {0, 2, 0}, .direction = {0, -1, 0}}, {}});
  scene.lights.push_back({"n", DirectionalLight{{0.2f, -1, 0}, Color(2)}, {}});
  check_batch(table_of(scene), "everything");
  scene.lights.resize(1);
  scene.environment.reset();
  check_batch(table_of(scene), "rectangle and triangles");
}

TEST(LightBatch, TexturedEmittersEqualTheScalarDefinition) {
  Scene scene = triangles(20, true);
  scene.images.push_back({"noise", std::make_shared<const Image>(Image{2, 2, 1, Image::Floats{0, 1, 2, 5}})});
  ImageTexture node;
  node.image = ImageId(std::size_t{0});
  scene.textures.push_back({"noise", node});
  scene.materials[0].emission.texture = TextureId(std::size_t{0});
  check_batch(table_of(scene), "textured triangles");
}

}  // namespace
}  // namespace sightline
