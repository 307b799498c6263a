// Bends a mesh by morph weights and joints.
#pragma once

#include <span>
#include <vector>

#include "scene/scene.h"

namespace sightline {

/// World-from-rest matrices of a skin's joints, given those of all nodes.
std::vector<Mat4> joint_matrices(const Skin& skin, std::span<const Mat4> world_from_node);

/// Sets positions, normals, tangents and bounds of a mesh from its arrays at rest. Weights that are missing are 0. A vertex that would not
/// be finite stays at rest. Missing joints (of a scene put together wrongly) leave the mesh unskinned.
void deform(Mesh& mesh, std::span<const float> target_weights, std::span<const Mat4> world_from_rest);

}  // namespace sightline
