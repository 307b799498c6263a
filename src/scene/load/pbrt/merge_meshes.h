// One mesh for all shapes of an object, so that an instance stays one instance.
#pragma once

#include <vector>

#include "scene/mesh.h"

namespace sightline::pbrt {

/// Joins meshes that have the same kinds of attributes; each has exactly one material, which goes into the palette.
std::vector<Mesh> merge_meshes(std::vector<Mesh> parts);

}  // namespace sightline::pbrt
