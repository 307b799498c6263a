#include "trace/placement.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/core/error.h"
#include "base/parallel/parallel.h"

namespace sightline {
namespace {

using Kind = PlacedMesh::Kind;
using ArrayKey = std::pair<const void*, const void*>;

ArrayKey key_of(const SharedArray<Vec3>& positions, const SharedArray<UVec3>& triangles) { return {positions.data(), triangles.data()}; }

// Nodes that move with time, themselves or through a parent (parents stand before their children).
std::vector<bool> animated_nodes(const Scene& scene) {
  std::vector<bool> animated(scene.nodes.size());
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    const Node& node = scene.nodes[i];
    animated[i] = node.is_animated() || (node.parent.valid() && node.parent.index < i && animated[node.parent.index]);
  }
  return animated;
}

struct Shape {
  double determinant = 0;
  bool invertible = false;  // in single precision, as Embree inverts it
  bool collapsed = false;   // to a line or point, or not finite
};

Shape shape_of(const Mat4& m) {
  Shape shape;
  for (int column = 0; column < 4; ++column) {
    if (!is_finite(Vec3(m[column]))) return {0, false, true};
  }
  const Vec3d x(m[0]), y(m[1]), z(m[2]);
  const double area = std::max({glm::length(glm::cross(x, y)), glm::length(glm::cross(y, z)), glm::length(glm::cross(z, x))});
  shape.determinant = glm::dot(x, glm::cross(y, z));
  shape.collapsed = !(area > 0);
  const double scale = glm::length(x) * glm::length(y) * glm::length(z), size = std::fabs(shape.determinant);
  shape.invertible = size > 1e-9 * scale && size > 1e-30 && size < 1e30;
  return shape;
}

SharedArray<Vec3> bake(const SharedArray<Vec3>& positions, const Mat4& world_from_object, const Context& context) {
  return SharedArray<Vec3>::make(positions.size(), [&](std::span<Vec3> world) {
    parallel_for(context, world.size(), std::size_t{1} << 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) world[i] = transform_point(world_from_object, positions[i]);
    });
  });
}

struct Earlier {
  const PlacedMesh* placed = nullptr;
  int uses = 0;
};

}  // namespace

std::size_t Placement::baked_count() const {
  return static_cast<std::size_t>(
      std::count_if(instances.begin(), instances.end(), [](const PlacedMesh& p) { return p.kind == Kind::baked; }));
}

namespace {

// Interface surfaces let everything pass, shadow rays too; unless one bounds a medium, it need not be traced at all.
bool is_nothing(const Scene& scene, const Instance& instance, const Mesh& mesh) {
  const auto passes = [&](MaterialId id) {
    if (!id.valid() || id.index >= scene.materials.size()) return false;
    const Material& material = scene.materials[id.index];
    return std::holds_alternative<InterfaceMaterial>(material.model) && !material.interior.valid();
  };
  if (instance.material_override.valid()) return passes(instance.material_override);
  return !mesh.materials.empty() && std::all_of(mesh.materials.begin(), mesh.materials.end(), passes);
}

}  // namespace

Placement place_meshes(const Scene& scene, const Context& context, const Placement* previous) {
  const std::vector<bool> animated = animated_nodes(scene);
  // Meshes are told apart by their arrays, so that two entries that share them count as one.
  std::map<ArrayKey, int> uses;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes.at(instance.mesh.index);
    if (mesh.source) throw Error(ErrorCode::bug, "mesh '" + mesh.name + "' was not materialised before tracing");
    ++uses[key_of(mesh.positions, mesh.triangles)];
  }
  std::map<ArrayKey, Earlier> earlier;
  if (previous) {
    for (const PlacedMesh& placed : previous->instances) {
      Earlier& entry = earlier[key_of(placed.mesh_positions, placed.triangles)];
      entry.placed = &placed;
      ++entry.uses;
    }
  }

  Placement result;
  result.instances.reserve(scene.instances.size());
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh.index];
    const ArrayKey key = key_of(mesh.positions, mesh.triangles);
    const Shape shape = shape_of(instance.world_from_object);
    PlacedMesh placed;
    placed.mesh_positions = mesh.positions;
    placed.triangles = mesh.triangles;
    placed.world_from_object = instance.world_from_object;
    placed.mirrored = shape.determinant < 0;

    const auto found = earlier.find(key);
    const Earlier before = found == earlier.end() ? Earlier{} : found->second;
    const bool same_as_before =
        before.uses == 1 && before.placed->kind == Kind::baked && before.placed->world_from_object == instance.world_from_object;
    const bool moves =
        mesh.is_deformable() || (instance.node.valid() && instance.node.index < animated.size() && animated[instance.node.index]);
    const bool edited = previous && !same_as_before;
    if (mesh.positions.empty() || mesh.triangles.empty() || shape.collapsed || is_nothing(scene, instance, mesh)) {
      placed.kind = Kind::absent;
    } else if (!shape.invertible || (uses[key] == 1 && !moves && !edited)) {
      // A flattened instance has no inverse to carry rays through, so it is baked however often it is used.
      placed.kind = Kind::baked;
    } else {
      placed.kind = Kind::instanced;
    }

    if (placed.kind == Kind::baked && placed.world_from_object != Mat4(1)) {
      placed.positions = same_as_before ? before.placed->positions : bake(mesh.positions, placed.world_from_object, context);
      result.copied_bytes += placed.positions.size_bytes();
    } else {
      placed.positions = mesh.positions;
    }
    result.instances.push_back(std::move(placed));
  }
  return result;
}

}  // namespace sightline
