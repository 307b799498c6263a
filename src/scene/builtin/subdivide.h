// Finer meshes of the same shape.
#pragma once

#include <cstdint>

#include "base/core/context.h"
#include "scene/scene.h"

namespace sightline::builtin {

/// Splits every triangle of every mesh at its edge midpoints, as often as it takes until the scene has `min_vertices` vertices.
/// Attributes are interpolated; the surface stays where it is. Meshes that are sources are left alone.
void subdivide(Scene& scene, std::uint64_t min_vertices, const Context& context);

}  // namespace sightline::builtin
