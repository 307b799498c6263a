#include <gtest/gtest.h>

#include <algorithm>

#include "base/core/error.h"
#include "methods/square_lights/shading_scene.h"
#include "scene/builtin/builtin.h"

namespace sightline::square_lights {
namespace {

Scene builtin(const char* spec) {
  Context context;
  return build_builtin(spec, {}, context);
}

std::shared_ptr<const World> world_at(const Scene& scene, float time_s) {
  Context context;
  return World::build(pose(scene, time_s), {}, context);
}

TEST(ShadingScene, NothingOfAMovingObjectChangesInItsOwnSpace) {
  const Scene scene = builtin("pair");
  const ShadingScene a(*world_at(scene, 0)), b(*world_at(scene, 0.7f));
  ASSERT_EQ(a.objects().size(), 3u);
  EXPECT_TRUE(a.any_moving());
  EXPECT_FALSE(a.objects()[0].moving);
  for (std::size_t o = 1; o < 3; ++o) {
    EXPECT_TRUE(a.objects()[o].moving);
    EXPECT_NE(a.objects()[o].world_from_object, b.objects()[o].world_from_object);
    EXPECT_EQ(a.objects()[o].object_from_member, b.objects()[o].object_from_member);
  }
  // To the last bit: keys of bakes hang on it.
  EXPECT_EQ(a.vertices().position, b.vertices().position);
  EXPECT_EQ(a.vertices().normal, b.vertices().normal);
  EXPECT_EQ(a.vertices().tangent, b.vertices().tangent);
}

TEST(ShadingScene, TakesKnownGeometryAndNoOther) {
  const Scene scene = builtin("pair");
  RecentValues recent;
  const auto first_world = world_at(scene, 0);
  const ShadingScene first(*first_world, &recent), moved(*world_at(scene, 0.7f), &recent);
  // The very same arrays, in other places.
  EXPECT_EQ(first.vertices().position.data(), moved.vertices().position.data());
  EXPECT_EQ(first.key(), moved.key());
  EXPECT_NE(first.objects()[1].world_from_object, moved.objects()[1].world_from_object);
  EXPECT_EQ(first.objects()[1].radius, ShadingScene(*first_world).objects()[1].radius);

  const auto expect_other = [&](const auto& change) {
    Scene changed = scene;
    change(changed);
    const ShadingScene other(*world_at(changed, 0), &recent);
    EXPECT_NE(other.key(), first.key());
    EXPECT_NE(other.vertices().position.data(), first.vertices().position.data());
  };
  expect_other([](Scene& s) { s.meshes.back().positions = SharedArray<Vec3>::copy_of(s.meshes.back().positions.span()); });
  expect_other([](Scene& s) { s.instances.back().material_override = MaterialId(std::size_t{0}); });
  expect_other([](Scene& s) { s.instances.pop_back(); });
}

TEST(ShadingScene, EveryVertexHasItsTurnAndNeighboursFollowOneAnother) {
  const ShadingScene scene(*world_at(builtin("pair"), 0));
  std::vector<std::uint32_t> sorted = scene.order();
  std::sort(sorted.begin(), sorted.end());
  for (std::uint32_t i = 0; i < sorted.size(); ++i) ASSERT_EQ(sorted[i], i);
  ASSERT_EQ(sorted.size(), scene.vertices().size());
  for (const ShadingObject& object : scene.objects()) {
    double in_order = 0, as_stored = 0;
    for (std::uint32_t i = object.first; i + 1 < object.first + object.count; ++i) {
      const std::uint32_t a = scene.order()[i], b = scene.order()[i + 1];
      EXPECT_LT(a - object.first, object.count);
      in_order += static_cast<double>(glm::length(scene.vertices().position[a] - scene.vertices().position[b]));
      as_stored += static_cast<double>(object.radius);
    }
    if (object.moving) {
      EXPECT_LT(in_order, 0.1 * as_stored);
    }
  }
}

TEST(ShadingScene, VerticesLieWhereHitsAre) {
  Context context;
  for (const char* spec : {"pair", "cornell", "spheres"}) {
    const Scene scene = builtin(spec);
    const std::shared_ptr<const World> world = world_at(scene, 0.4f);
    const ShadingScene shading(*world);
    const Bounds bounds = world->bounds();
    RayBatch rays;
    rays.resize(64);
    for (std::size_t i = 0; i < 64; ++i) {
      const float a = static_cast<float>(i);
      const Vec3 from = 0.5f * (bounds.lower + bounds.upper) + 3 * bounds.half_diagonal() * Vec3(std::sin(a), 0.7f, std::cos(a));
      const Vec3 to = glm::mix(bounds.lower, bounds.upper, Vec3(0.5f + 0.3f * std::sin(3 * a), 0.4f, 0.5f + 0.3f * std::cos(5 * a)));
      rays.set(i, {from, 0, glm::normalize(to - from)});
    }
    HitBatch hits;
    SurfaceBatch surfaces;
    RayCounts counts;
    world->tracer().intersect(rays, hits, BatchKind::primary, counts);
    world->surfaces(rays, hits, surfaces);
    int found = 0;
    for (std::size_t i = 0; i < 64; ++i) {
      if (!hits.hit(i)) continue;
      ++found;
      const Vec3 position(surfaces.position.x[i], surfaces.position.y[i], surfaces.position.z[i]);
      const Vec3 normal(surfaces.shading_normal.x[i], surfaces.shading_normal.y[i], surfaces.shading_normal.z[i]);
      const ShadingObject& object = shading.objects()[shading.object_of(hits.instance[i])];
      const VertexHit hit = shading.vertices_of(hits, i, position);
      Vec3 place(0), up(0);
      for (std::size_t k = 0; k < 3; ++k) {
        ASSERT_GE(hit.vertex[k], object.first);
        ASSERT_LT(hit.vertex[k], object.first + object.count);
        place += hit.weight[k] * shading.vertices().position[hit.vertex[k]];
        up += hit.weight[k] * shading.vertices().normal[hit.vertex[k]];
      }
      // Nets of spheres are chords.
      const float tolerance = hits.instance[i] & kSphereBit ? 2e-3f : 1e-5f;
      EXPECT_LT(glm::length(transform_point(object.world_from_object, place) - position), tolerance * bounds.half_diagonal()) << spec;
      EXPECT_GT(std::fabs(glm::dot(glm::normalize(transform_vector(object.world_from_object, up)), normal)), 0.998f) << spec;
    }
    EXPECT_GT(found, 10) << spec;
  }
}

TEST(ShadingScene, CornersOfOnePlaneAreOneVertex) {
  const ShadingScene ground(*world_at(builtin("ground,content=quad"), 0));
  // 200 x 200 of the ground, and those of a quad.
  EXPECT_EQ(ground.vertices().size(), 200u * 200u + 4u);
  // A box without normals has three corners at each of its eight.
  const ShadingScene box(*world_at(builtin("furnace,shape=box"), 0));
  EXPECT_EQ(box.vertices().size(), 24u);
}

TEST(ShadingScene, AMovingObjectMustKeepItsShape) {
  Scene scene = builtin("pair");
  for (Node& node : scene.nodes) {
    if (node.is_animated()) node.scale = {1, 2, 1};
  }
  EXPECT_THROW(ShadingScene(*world_at(scene, 0)), Error);
}

TEST(ShadingScene, ObjectsHaveSpheresAroundThem) {
  const ShadingScene scene(*world_at(builtin("pair"), 0));
  for (const ShadingObject& object : scene.objects()) {
    for (std::uint32_t i = object.first; i < object.first + object.count; ++i)
      ASSERT_LE(glm::length(scene.vertices().position[i] - object.center), object.radius);
  }
}

}  // namespace
}  // namespace sightline::square_lights
