// How densely points lie on the surfaces of a scene, by their nearest neighbours.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/core/context.h"
#include "base/math/vec.h"

namespace sightline::vpl {

/// Area that each point stands for: that of the disk which reaches to its k-th nearest neighbour, over k; of points scattered at random
/// its mean is 1 over their density. Fewer neighbours than k: as many as there are. A point alone stands for `largest`, which no area
/// exceeds; nor is any below `smallest`.
std::vector<float> neighbour_areas(std::span<const Vec3> points, std::size_t k, float smallest, float largest, const Context& context);

}  // namespace sightline::vpl
