// How much of each patch of the local lights is seen from each vertex of what stands still, traced once.
#pragma once

#include <cstdint>
#include <span>

#include "base/core/aligned.h"
#include "base/core/context.h"
#include "methods/square_lights/local_light.h"
#include "methods/square_lights/self_visibility.h"
#include "trace/tracer.h"

namespace sightline::square_lights {

/// Rays to a patch.
inline constexpr int kPatchRays = 16;

/// 255 = all of it; [vertex][patch of all lights in order]. Vertices are in the tracer's space, which is the lights'. Distances to
/// infinity, as vertices' tables have them, would let the walls behind a lamp hide it.
AlignedVector<std::uint8_t> trace_patches(const Tracer& tracer, const VertexSpans& vertices, std::span<const LocalLight> lights,
                                          RayCounts& rays, const Context& context);

/// Patches of all lights.
std::size_t patch_count(std::span<const LocalLight> lights);

}  // namespace sightline::square_lights
