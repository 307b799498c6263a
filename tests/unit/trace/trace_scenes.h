// Scenes and rays for tests of tracers, from fixed seeds.
#pragma once

#include <random>
#include <vector>

#include "scene/scene.h"
#include "trace/ray_batch.h"

namespace sightline::test {

inline Vec3 random_point(std::mt19937& random, float size) {
  std::uniform_real_distribution<float> coordinate(-size, size);
  const float x = coordinate(random), y = coordinate(random), z = coordinate(random);
  return {x, y, z};
}

inline Vec3 random_direction(std::mt19937& random) {
  std::normal_distribution<float> normal;
  for (;;) {
    const float x = normal(random), y = normal(random), z = normal(random);
    const Vec3 v{x, y, z};
    if (glm::length(v) > 1e-3f) return glm::normalize(v);
  }
}

inline Mesh make_mesh(const std::vector<Vec3>& positions, const std::vector<UVec3>& triangles) {
  Mesh mesh;
  mesh.positions = positions;
  mesh.triangles = triangles;
  for (const Vec3& p : positions) mesh.bounds.add(p);
  return mesh;
}

/// Loose triangles of about `edge` inside a cube of half width `size` around `center`.
inline Mesh triangle_soup(std::mt19937& random, int count, float size, float edge, const Vec3& center = Vec3(0)) {
  std::vector<Vec3> positions;
  std::vector<UVec3> triangles;
  for (int i = 0; i < count; ++i) {
    const Vec3 at = center + random_point(random, size);
    const auto first = static_cast<std::uint32_t>(positions.size());
    for (int corner = 0; corner < 3; ++corner) positions.push_back(at + random_point(random, edge));
    triangles.push_back({first, first + 1, first + 2});
  }
  return make_mesh(positions, triangles);
}

/// Closed box between two corners, normals outward.
inline Mesh box_mesh(const Vec3& lower, const Vec3& upper) {
  std::vector<Vec3> positions;
  for (int corner = 0; corner < 8; ++corner) {
    positions.push_back({corner & 1 ? upper.x : lower.x, corner & 2 ? upper.y : lower.y, corner & 4 ? upper.z : lower.z});
  }
  return make_mesh(
      positions,
      {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}});
}

inline void place(Scene& scene, Mesh mesh, const Mat4& world_from_object = Mat4(1)) {
  scene.meshes.push_back(std::move(mesh));
  Instance instance;
  instance.mesh = MeshId(scene.meshes.size() - 1);
  instance.world_from_object = world_from_object;
  scene.instances.push_back(instance);
}

inline Scene scene_of(Mesh mesh, const Mat4& world_from_object = Mat4(1)) {
  Scene scene;
  place(scene, std::move(mesh), world_from_object);
  return scene;
}

/// Rays from a cube of half width 2 `size` towards points within `size` of `center`; every seventh is inactive, some are short.
inline RayBatch random_rays(std::mt19937& random, std::size_t count, float size, const Vec3& center = Vec3(0)) {
  RayBatch rays;
  rays.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    Ray ray;
    ray.origin = center + random_point(random, 2 * size);
    ray.direction = center + random_point(random, size) - ray.origin;
    if (i % 3 == 0) ray.t_far = 1.f;
    if (i % 7 == 6) ray.t_near = 1, ray.t_far = 0.5f;
    rays.set(i, ray);
  }
  return rays;
}

}  // namespace sightline::test
