// Loop's subdivision surfaces.
#pragma once

#include <span>
#include <vector>

#include "scene/load/pbrt/geometry.h"
#include "scene/load/pbrt/place.h"

namespace sightline::pbrt {

/// The mesh after `levels` rounds of Loop subdivision [Loop1987], pushed to the limit surface, with its normals. Throws Error{input} for
/// bad indices or edges with more than two faces. Four triangles a level: the caller bounds `levels`.
MeshArrays subdivide_loop(std::vector<Vec3> positions, std::span<const std::int32_t> indices, int levels, const Place& place);

}  // namespace sightline::pbrt
