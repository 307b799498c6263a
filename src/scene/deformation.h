// Meshes that bend: morph targets and skins [glTF2, §3.7.2, §3.7.3].
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/core/shared_array.h"
#include "base/math/vec.h"
#include "scene/ids.h"

namespace sightline {

/// Displacements of every vertex at weight 1; empty arrays displace nothing.
struct MorphTarget {
  std::string name;
  SharedArray<Vec3> positions, normals, tangents;
};

/// What the vertices of a mesh are computed from when the scene is posed: arrays at rest, displaced by targets, then carried by joints.
/// Immutable and shared, so that a posed copy of the scene costs the deformed arrays alone.
struct Deformation {
  SharedArray<Vec3> positions, normals;  ///< at rest
  SharedArray<Vec4> tangents;
  std::vector<MorphTarget> targets;
  /// Joints (indices into the skin's list, all within it) and their weights (sum 1), `influences` of each a vertex; 0 = no skin.
  std::size_t influences = 0;
  SharedArray<std::uint16_t> joints;
  SharedArray<float> joint_weights;
};

/// Joints that carry meshes. A vertex at rest goes to world space by the sum of weight * world_from_joint * joint_from_rest.
struct Skin {
  std::string name;
  std::vector<NodeId> joints;
  std::vector<Mat4> joint_from_rest;  ///< inverse bind matrices, one a joint
};

}  // namespace sightline
