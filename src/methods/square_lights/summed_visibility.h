// The rival to distance tables: summed-area tables of a vertex's visibility (§4.3 of the paper).
#pragma once

#include <span>

#include "methods/square_lights/shade_lanes.h"

namespace sightline::square_lights {

/// visible[i] = mean visibility over square i, from summed-area tables of what the distance tables' cells see.
void summed_visibility(const ReceiverTables& tables, const LightSet& lights, float plane_scale, std::span<float> visible);

}  // namespace sightline::square_lights
