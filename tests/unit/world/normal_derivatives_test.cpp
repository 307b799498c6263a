// How shading normals turn along a surface.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "unit/trace/trace_scenes.h"
#include "world/world.h"

namespace sightline {
namespace {

using namespace test;
using glm::dvec3;

// What the derivatives say of a step in the surface, found by least squares.
dvec3 predicted_turn(const SurfaceDetail& detail, const dvec3& step) {
  const dvec3 du(detail.dp_du), dv(detail.dp_dv);
  const double uu = glm::dot(du, du), uv = glm::dot(du, dv), vv = glm::dot(dv, dv), a = glm::dot(step, du), b = glm::dot(step, dv);
  const double determinant = uu * vv - uv * uv;
  return (vv * a - uv * b) / determinant * dvec3(detail.dn_du) + (uu * b - uv * a) / determinant * dvec3(detail.dn_dv);
}

// Triangles whose corners have normals of their own, with and without texture coordinates, once baked and twice instanced, one mirrored.
TEST(NormalDerivatives, MatchFiniteDifferencesOnTriangles) {
  std::mt19937 random(31);
  for (const bool textured : {false, true}) {
    Mesh mesh = triangle_soup(random, 30, 1, 0.6f);
    mesh.normals = SharedArray<Vec3>::make(mesh.positions.size(), [&](std::span<Vec3> normals) {
      for (std::size_t i = 0; i < normals.size(); i += 3) {
        const Vec3 n = glm::normalize(glm::cross(mesh.positions[i + 1] - mesh.positions[i], mesh.positions[i + 2] - mesh.positions[i]));
        // Files that disagree with their winding are believed in all but the side.
        const float side = i % 2 == 0 ? 1.f : -1.f;
        for (std::size_t k = 0; k < 3; ++k) normals[i + k] = side * glm::normalize(n + random_point(random, 0.4f));
      }
    });
    if (textured) {
      mesh.uvs = SharedArray<Vec2>::make(mesh.positions.size(), [&](std::span<Vec2> uvs) {
        for (Vec2& uv : uvs) uv = Vec2(random_point(random, 1));
      });
    }
    Scene scene = scene_of(mesh);
    const Mat4 turned = glm::scale(glm::rotate(glm::translate(Mat4(1), Vec3{5, 0, 0}), 1.f, Vec3{1, 2, 3}), Vec3{1, 0.5f, 1.5f});
    for (const Mat4& m : {turned, glm::scale(turned, Vec3{-1, 1, 1})}) {
      Instance instance = scene.instances[0];
      instance.world_from_object = m;
      scene.instances.push_back(instance);
    }
    const auto world = World::build(scene, {}, Context());
    int checked = 0;
    for (const Vec3& center : {Vec3(0), Vec3{5, 0, 0}}) {
      const RayBatch rays = random_rays(random, 1500, 2, center);
      HitBatch hits;
      RayCounts counts;
      world->tracer().intersect(rays, hits, BatchKind::bounce, counts);
      for (std::size_t i = 0; i < hits.size; ++i) {
        if (!hits.hit(i)) continue;
        const PlacedMesh& placed = world->tracer().placement().instances[hits.instance[i]];
        const UVec3 t = mesh.triangles[hits.primitive[i]];
        const auto corner = [&](std::uint32_t k) { return dvec3(transform_point(placed.world_from_positions(), placed.positions[k])); };
        const SurfaceDetail detail = world->detail(rays, hits, i, 0);
        constexpr float kStep = 1.f / 256;
        for (const bool second : {false, true}) {
          const auto normal_at = [&](float shift) {
            HitBatch moved = hits;
            (second ? moved.v : moved.u)[i] += shift;
            return dvec3(world->detail(rays, moved, i, 0).frame.normal);
          };
          const dvec3 measured = (normal_at(kStep) - normal_at(-kStep)) / (2.0 * kStep);
          const dvec3 predicted = predicted_turn(detail, corner(second ? t.z : t.y) - corner(t.x));
          // Slivers have derivatives that floats hold badly.
          EXPECT_LT(glm::length(measured - predicted), 0.01 + 0.01 * glm::length(measured)) << textured << " " << hits.instance[i];
          EXPECT_GT(glm::length(measured), 0);
          ++checked;
        }
      }
    }
    EXPECT_GT(checked, 400);
  }
}

TEST(NormalDerivatives, VanishOnFlatTriangles) {
  std::mt19937 random(32);
  const auto world = World::build(scene_of(triangle_soup(random, 30, 1, 0.6f)), {}, Context());
  const RayBatch rays = random_rays(random, 200, 2);
  HitBatch hits;
  RayCounts counts;
  world->tracer().intersect(rays, hits, BatchKind::bounce, counts);
  for (std::size_t i = 0; i < hits.size; ++i) {
    if (!hits.hit(i)) continue;
    const SurfaceDetail detail = world->detail(rays, hits, i, 0);
    EXPECT_EQ(detail.dn_du, Vec3(0));
    EXPECT_EQ(detail.dn_dv, Vec3(0));
  }
}

TEST(NormalDerivatives, OfSpheresAreThoseOfPositionsOverTheRadius) {
  for (const bool reversed : {false, true}) {
    Scene scene;
    Sphere sphere;
    sphere.center = {1, 2, 3}, sphere.radius = 2.5f, sphere.reverse_orientation = reversed;
    scene.spheres.push_back(sphere);
    const auto world = World::build(scene, {}, Context());
    std::mt19937 random(33);
    RayBatch rays;
    rays.resize(300);
    for (std::size_t i = 0; i < rays.size; ++i) {
      const Vec3 d = random_direction(random);
      rays.set(i, {.origin = sphere.center + 5.f * d, .direction = -d});
    }
    HitBatch hits;
    RayCounts counts;
    world->tracer().intersect(rays, hits, BatchKind::bounce, counts);
    for (std::size_t i = 0; i < rays.size; ++i) {
      ASSERT_TRUE(hits.hit(i));
      const SurfaceDetail detail = world->detail(rays, hits, i, 0);
      // A step in the tangent plane turns the normal by itself over the radius.
      const dvec3 step = dvec3(detail.frame.tangent) + 0.5 * dvec3(detail.frame.bitangent);
      const dvec3 turn = (reversed ? -step : step) / 2.5;
      EXPECT_LT(glm::length(predicted_turn(detail, step) - turn), 1e-4) << reversed;
    }
  }
}

}  // namespace
}  // namespace sightline
