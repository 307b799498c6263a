// The environment as a cube map of few texels, from which square lights are made.
#pragma once

#include <functional>
#include <vector>

#include "base/core/context.h"
#include "base/math/vec.h"
#include "scene/light.h"
#include "shade/cube_map.h"

namespace sightline::square_lights {

/// Radiance by texel, constant within each, in the environment's own frame.
struct LightCube {
  int size = 32;              ///< texels along an edge of a face
  std::vector<Color> texels;  ///< (face * size + y) * size + x

  std::size_t count() const { return texels.size(); }
  Vec3 center(std::size_t texel) const;        ///< unit direction of the texel's centre
  float solid_angle(std::size_t texel) const;  ///< steradians
  std::size_t texel_of(const Vec3& direction) const;
  Color integral() const;  ///< of radiance over the sphere
};

/// Means of an environment over texels by solid angle, in its own frame, times its scale: every pixel of its picture counts (see
/// cube_resample.h).
LightCube light_cube_of(const Environment& environment, int size, const Context& context);
/// The same of any `radiance(unit direction)`, from `points` x `points` of each texel.
LightCube make_light_cube(const std::function<Color(const Vec3&)>& radiance, int size, int points, const Context& context);

}  // namespace sightline::square_lights
