// Closed smooth bodies of any number of vertices, for scenes in which things move.
#pragma once

#include <cstdint>

#include "scene/scene.h"

namespace sightline::builtin {

// Each has about `vertex_count` vertices (those of a grid that comes close), smooth normals, and a bounding ball of radius 1 around the
// origin that it touches. `seed` varies turns, bumps and teeth.

/// A tube around a curve that winds `p` times about an axis while it goes round `q` times.
Mesh torus_knot(std::uint64_t vertex_count, std::uint64_t seed);
/// A ball that is displaced by waves.
Mesh bumpy_ball(std::uint64_t vertex_count, std::uint64_t seed);
/// A ring with rounded edges and teeth on its outside.
Mesh gear(std::uint64_t vertex_count, std::uint64_t seed);

/// Vertices that the smallest of these bodies have.
inline constexpr std::uint64_t kLeastSolidVertices = 200;

}  // namespace sightline::builtin
