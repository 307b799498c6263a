// Decides how each instance of a scene is presented to tracers: baked into world space, or instanced through its transform.
#pragma once

#include <cstdint>
#include <vector>

#include "base/core/context.h"
#include "base/core/shared_array.h"
#include "base/math/vec.h"
#include "scene/scene.h"

namespace sightline {

/// The triangles of one entry of Scene::instances as rays see them. Hits are reconstructed from these very vertices.
struct PlacedMesh {
  enum class Kind {
    baked,      ///< used once and still: vertices in world space, part of the static scene
    instanced,  ///< used more than once, animated or edited: object space behind a transform
    absent,     ///< nothing to hit: no triangles, a transform that collapses them, or interfaces that bound no medium
  };
  Kind kind = Kind::absent;
  SharedArray<Vec3> positions;       ///< in world space if baked, else the mesh's own
  SharedArray<UVec3> triangles;      ///< the mesh's own
  bool mirrored = false;             ///< the transform turns the winding round: the geometric normal is minus the winding's
  Mat4 world_from_object{1};         ///< the instance's own transform (already applied to `positions` if baked)
  SharedArray<Vec3> mesh_positions;  ///< what `positions` was made from: recognised by later edits

  /// Transform that still has to be applied to `positions`.
  Mat4 world_from_positions() const { return kind == Kind::baked ? Mat4(1) : world_from_object; }
};

/// All instances of a scene, in its order.
struct Placement {
  std::vector<PlacedMesh> instances;
  std::uint64_t copied_bytes = 0;  ///< world-space copies of vertices
  /// Instances in the static part.
  std::size_t baked_count() const;
};

/// Geometry used once and not animated is baked (identity transforms share the mesh's array); the rest is instanced. With the placement of
/// an earlier version of the scene, what was baked stays baked where it did not change, and whatever moved or is new becomes an instance,
/// so that the next edit of it is cheap. Throws Error{bug} if a mesh still has a source.
Placement place_meshes(const Scene& scene, const Context& context, const Placement* previous = nullptr);

}  // namespace sightline
