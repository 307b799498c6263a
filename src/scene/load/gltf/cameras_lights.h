// Cameras and KHR_lights_punctual.
#pragma once

#include "scene/load/gltf/import.h"

namespace sightline::gltf {

/// Adds the camera with the index that `reference` holds, on a node.
void add_camera(Import& import, const JsonView& reference, NodeId node);
/// Adds the light that a node's KHR_lights_punctual object names.
void add_light(Import& import, const JsonView& node_extension, NodeId node);

}  // namespace sightline::gltf
