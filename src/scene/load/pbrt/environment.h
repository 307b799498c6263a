// What an infinite light's image needs.
#pragma once

#include "base/math/vec.h"
#include "image/image.h"

namespace sightline::pbrt {

/// Direction of a point of the unit square under pbrt-v4's equal-area octahedral map [Clarberg2008]; (x, y) from the image's top left.
Vec3 equal_area_direction(const Vec2& point);
/// Illuminance of an upward-facing (+z) patch under a square image of that mapping.
double upper_illuminance(const Image& image);
/// pbrt-v3's light space (z up, u = phi / 2 pi) from Sightline's latitude-longitude space (y up, -z in the middle).
glm::mat3 latlong_of_v3();

}  // namespace sightline::pbrt
