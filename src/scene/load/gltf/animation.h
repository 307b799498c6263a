// Animation of nodes and of the weights of morph targets.
#pragma once

#include "scene/load/gltf/import.h"
#include "scene/load/gltf/nodes.h"

namespace sightline::gltf {

/// Puts the channels of all animations onto the scene's nodes; where two move the same property, the first one wins.
void import_animations(Import& import, const NodeMap& nodes);

}  // namespace sightline::gltf
