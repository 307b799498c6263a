// The six faces of a cube map: which direction is where.
#pragma once

#include <cmath>
#include <cstdint>

#include "base/math/vec.h"

namespace sightline {

inline constexpr int kCubeFaces = 6;

/// A place on the cube: faces +X, -X, +Y, -Y, +Z, -Z; u to the right and v down as OpenGL has them, both in [-1, 1].
struct CubePlace {
  int face = 0;
  float u = 0, v = 0;
};

/// Not normalised: its largest component is 1.
inline Vec3 cube_direction(int face, float u, float v) {
  switch (face) {
    case 0:
      return {1, -v, -u};
    case 1:
      return {-1, -v, u};
    case 2:
      return {u, 1, v};
    case 3:
      return {u, -1, -v};
    case 4:
      return {u, -v, 1};
    default:
      return {-u, -v, -1};
  }
}

/// The inverse, for any direction but 0.
inline CubePlace cube_place(const Vec3& d) {
  const float ax = std::fabs(d.x), ay = std::fabs(d.y), az = std::fabs(d.z);
  if (ax >= ay && ax >= az) return d.x > 0 ? CubePlace{0, -d.z / ax, -d.y / ax} : CubePlace{1, d.z / ax, -d.y / ax};
  if (ay >= az) return d.y > 0 ? CubePlace{2, d.x / ay, d.z / ay} : CubePlace{3, d.x / ay, -d.z / ay};
  return d.z > 0 ? CubePlace{4, d.x / az, -d.y / az} : CubePlace{5, -d.x / az, -d.y / az};
}

/// Centre of texel `i` of `size` along one axis, in [-1, 1].
inline float cube_coordinate(int i, int size) { return (2 * static_cast<float>(i) + 1) / static_cast<float>(size) - 1; }

/// Solid angle of the rectangle [u0, u1] x [v0, v1] of a face, exactly.
inline float cube_solid_angle(float u0, float v0, float u1, float v1) {
  const auto corner = [](double u, double v) { return std::atan2(u * v, std::sqrt(u * u + v * v + 1)); };
  return static_cast<float>(corner(u1, v1) - corner(u0, v1) - corner(u1, v0) + corner(u0, v0));
}

/// Solid angle of texel (x, y) of a face of `size` x `size`; all faces are alike.
inline float cube_texel_solid_angle(int x, int y, int size) {
  const auto edge = [size](int i) { return 2 * static_cast<float>(i) / static_cast<float>(size) - 1; };
  return cube_solid_angle(edge(x), edge(y), edge(x + 1), edge(y + 1));
}

}  // namespace sightline
