// Vertex normals for meshes that come without.
#pragma once

#include "base/core/context.h"
#include "scene/scene.h"

namespace sightline::builtin {

/// Vertices at one position that a mesh lists more than once (seams of patches, triangles without shared corners) get the same normal
/// where those of the listed ones differ by less than this: seams vanish, while edges that such a list keeps apart on purpose stay.
inline constexpr float kCreaseAngleRad = kPi / 3;

/// Gives every mesh without normals the means of those of the triangles around each vertex, weighted by their angle there
/// [Thurmer1998]: the result does not depend on how a surface is cut into triangles. A vertex that the list shares between triangles has
/// one normal, however sharp the edge. Meshes that are sources are left alone.
void add_smooth_normals(Scene& scene, const Context& context);
void add_smooth_normals(Mesh& mesh);

}  // namespace sightline::builtin
