#include "scene/scene.h"

#include <unordered_set>

namespace sightline {
namespace {

/// A matrix whose linear part only scales and swaps axes maps boxes to boxes, so that the corners give the exact answer.
bool maps_axes_to_axes(const Mat4& m) {
  for (int column = 0; column < 3; ++column) {
    int nonzero = 0;
    for (int row = 0; row < 3; ++row) nonzero += m[column][row] != 0;
    if (nonzero > 1) return false;
  }
  return true;
}

/// Box of a placed mesh: exact over the vertices where a rotation would loosen the box of the corners, unless instancing makes that long.
Bounds instance_bounds(const Mesh& mesh, const Mat4& world_from_object, std::uint64_t& vertex_budget) {
  if (mesh.positions.empty() || maps_axes_to_axes(world_from_object) || mesh.positions.size() > vertex_budget) {
    return transform_bounds(world_from_object, mesh.bounds);
  }
  vertex_budget -= mesh.positions.size();
  // Over the triangles, since vertices that none of them uses do not show.
  Bounds bounds;
  for (const UVec3& triangle : mesh.triangles) {
    for (int corner = 0; corner < 3; ++corner) bounds.add(transform_point(world_from_object, mesh.positions[triangle[corner]]));
  }
  return bounds.is_empty() ? transform_bounds(world_from_object, mesh.bounds) : bounds;
}

}  // namespace

Bounds scene_bounds(const Scene& scene) {
  Bounds bounds;
  std::uint64_t vertex_budget = std::uint64_t{1} << 24;
  for (const Instance& instance : scene.instances) {
    if (!instance.mesh.valid() || instance.mesh.index >= scene.meshes.size()) continue;
    bounds.add(instance_bounds(scene.meshes[instance.mesh.index], instance.world_from_object, vertex_budget));
  }
  for (const Sphere& sphere : scene.spheres) {
    bounds.add(sphere.center - Vec3(sphere.radius));
    bounds.add(sphere.center + Vec3(sphere.radius));
  }
  return bounds;
}

std::uint64_t instanced_triangle_count(const Scene& scene) {
  std::uint64_t count = 0;
  for (const Instance& instance : scene.instances) {
    if (instance.mesh.index < scene.meshes.size()) count += scene.meshes[instance.mesh.index].triangle_count();
  }
  return count;
}

std::uint64_t scene_bytes(const Scene& scene) {
  std::unordered_set<const void*> seen;
  std::uint64_t bytes = 0;
  const auto add = [&](const void* data, std::uint64_t size) {
    if (data != nullptr && seen.insert(data).second) bytes += size;
  };
  const auto add_deformation = [&](const Deformation& d) {
    add(d.positions.data(), d.positions.size_bytes());
    add(d.normals.data(), d.normals.size_bytes());
    add(d.tangents.data(), d.tangents.size_bytes());
    add(d.joints.data(), d.joints.size_bytes());
    add(d.joint_weights.data(), d.joint_weights.size_bytes());
    for (const MorphTarget& target : d.targets) {
      add(target.positions.data(), target.positions.size_bytes());
      add(target.normals.data(), target.normals.size_bytes());
      add(target.tangents.data(), target.tangents.size_bytes());
    }
  };
  for (const Mesh& mesh : scene.meshes) {
    add(mesh.positions.data(), mesh.positions.size_bytes());
    add(mesh.normals.data(), mesh.normals.size_bytes());
    add(mesh.uvs.data(), mesh.uvs.size_bytes());
    add(mesh.tangents.data(), mesh.tangents.size_bytes());
    add(mesh.triangles.data(), mesh.triangles.size_bytes());
    add(mesh.triangle_materials.data(), mesh.triangle_materials.size_bytes());
    if (mesh.deformation) add_deformation(*mesh.deformation);
  }
  for (const ImageAsset& asset : scene.images) {
    if (asset.image) add(asset.image.get(), asset.image->size_bytes());
  }
  if (scene.environment && scene.environment->image) add(scene.environment->image.get(), scene.environment->image->size_bytes());
  return bytes;
}

}  // namespace sightline
