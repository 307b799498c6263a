// The case table of marching cubes, derived instead of typed in.
#pragma once

#include <array>
#include <cstdint>

namespace sightline::builtin {

/// Triangles of one case, three cube edges each. Corner c of a cube is at (c & 1, c >> 1 & 1, c >> 2); edges 0-3 run along x at (y, z) =
/// (e & 1, e >> 1), 4-7 along y at (x, z), 8-11 along z at (x, y).
struct CubeCase {
  std::uint8_t triangle_count = 0;
  std::array<std::array<std::uint8_t, 3>, 10> triangles{};
};

/// Indexed by the set of corners inside [Lorensen1987]. On a face with two opposite corners inside they are always separated, so that
/// neighbouring cubes agree and the surface has no holes; no triangle's inner edge lies in a face, so no edge has more than two triangles.
/// Triangles face outward.
const std::array<CubeCase, 256>& marching_cubes_table();

}  // namespace sightline::builtin
