// Merging by moments: regions that keep where light comes from, rather than what it looks like.
#pragma once

#include "methods/square_lights/merge_tree.h"

namespace sightline::square_lights {

/// The tree of MergeOptions::Criterion::moments. Each light lies at the centroid of its region's luminance and has its second moment, so
/// that smooth transport sees no difference to second order; merged is what adds least to the sum over channels of (flux² x mean squared
/// distance from the centre), which is what a square may be wrong by where transport is not smooth. Regions may cross the edges of faces.
MergeTree merge_by_moments(const LightCube& cube, const MergeOptions& options, const Context& context);

}  // namespace sightline::square_lights
