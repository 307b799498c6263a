// An environment as a cube map of few texels, so that every method can render the very same piecewise constant light.
#pragma once

#include <functional>
#include <vector>

#include "base/core/context.h"
#include "base/math/vec.h"
#include "scene/light.h"

namespace sightline {

/// Means of `radiance(unit direction)` over the texels of a cube map by solid angle, from `points` x `points` of each. Texel (x, y) of a
/// face stands at (face * size + y) * size + x.
std::vector<Color> resample_to_cube(const std::function<Color(const Vec3&)>& radiance, int size, int points, const Context& context);

/// Points along an edge of a texel that catch every pixel of the environment's picture: at least 16, and four a pixel while that is not
/// too slow.
int cube_points(const Environment& environment, int size);

/// The same light as a cube map with faces of `size` x `size` texels, in the environment's own frame: its transform and scale stay.
/// Another cube map is averaged exactly.
Environment environment_as_cube(const Environment& environment, int size, const Context& context);

/// Largest size that environment_as_cube takes.
inline constexpr int kMaxCubeSize = 4096;

}  // namespace sightline
