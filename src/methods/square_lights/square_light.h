// What an environment is split into: squares on the sphere that turn by turning their centres.
#pragma once

#include "base/math/vec.h"

namespace sightline::square_lights {

/// A square of constant radiance around a direction. In Lambert's azimuthal coordinates about the centre (distance 2 sin(angle / 2)) its
/// half diagonal is r and its edge r sqrt(2), so that its solid angle is exactly 2 r²; its turn about the centre is left open.
struct SquareLight {
  Vec3 center{0, 0, 1};  ///< c: unit, in the frame of the environment
  float radius = 0;      ///< r
  Color radiance{0};     ///< I
  float solid_angle() const { return 2 * radius * radius; }
};

}  // namespace sightline::square_lights
