// The node hierarchy of the scene that is shown, and what hangs on it.
#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "scene/load/gltf/import.h"
#include "scene/load/gltf/meshes.h"

namespace sightline::gltf {

/// Scene node of each glTF node that the shown scene reaches.
using NodeMap = std::map<std::size_t, NodeId>;

/// Fills scene.nodes with the hierarchy of the default scene, parents first. Cycles and second parents are errors.
NodeMap import_nodes(Import& import);
/// Hangs meshes, cameras and lights on the nodes; animations must have been read.
void attach_to_nodes(Import& import, const NodeMap& nodes, MeshImporter& meshes);

}  // namespace sightline::gltf
