// Polygons to triangles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/math/vec.h"

namespace sightline::obj {

/// Appends triangles of corner numbers (0 .. corners.size() - 1) that cover the polygon, wound as it is. Convex polygons become fans,
/// concave ones lose ears [Meisters1975]; a polygon that crosses itself still gives corners.size() - 2 triangles.
void triangulate(std::span<const Vec3> corners, std::vector<UVec3>& triangles);

}  // namespace sightline::obj
