// Directions along which surfaces are brushed, where a file has none.
#pragma once

#include "scene/scene.h"

namespace sightline {

/// Gives tangents to the meshes that have an anisotropic material but no tangents, so that lobes turn smoothly across triangles: the mean
/// of dp/du around each vertex, or without texture coordinates circles about the vertical axis through the mesh's middle (in object space),
/// as if turned on a lathe. Other meshes and streamed ones stay as they are.
void add_missing_tangents(Scene& scene);

}  // namespace sightline
