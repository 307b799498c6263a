// Visibility traced texel by texel of a cube map: the truth that square lights are measured against.
#pragma once

#include <cstdint>
#include <span>

#include "base/core/aligned.h"
#include "base/core/context.h"
#include "base/math/frame.h"
#include "base/math/vec.h"
#include "methods/square_lights/light_cube.h"
#include "shade/bsdf.h"
#include "trace/tracer.h"

namespace sightline::square_lights {

/// Points along an edge of a texel, and in it.
inline constexpr int kSubTexels = 4, kTexelPoints = kSubTexels * kSubTexels;

/// Directions to all points of all texels, unit, [texel][point], with the solid angle that each stands for.
struct TexelDirections {
  Vec3Batch direction;
  AlignedVector<float> solid_angle;
  std::size_t texels = 0;
};
TexelDirections texel_directions(int size, const Mat3& world_from_environment);

/// One bit a point for each vertex and texel: 1 where nothing is in the way. Points below either of the vertex's normals are 0. Arrays are
/// in world space and of one length.
AlignedVector<std::uint16_t> trace_texels(const Tracer& tracer, std::span<const Vec3> position, std::span<const Vec3> normal,
                                          std::span<const Vec3> geometric_normal, std::span<const float> error,
                                          const TexelDirections& directions, RayCounts& rays, const Context& context);

/// Mean over each texel of visibility times BRDF times cosine, for outgoing `wo` in `frame`.
void texel_transport(std::span<const std::uint16_t> masks, const TexelDirections& directions, const Bsdf& bsdf, const Frame3& frame,
                     const Vec3& wo, std::span<Color> transport);

}  // namespace sightline::square_lights
