// What each vertex of an object sees past the object itself.
#pragma once

#include <cstdint>
#include <span>

#include "base/core/aligned.h"
#include "base/core/context.h"
#include "base/math/frame.h"
#include "base/math/vec.h"
#include "methods/square_lights/distance_table.h"
#include "trace/tracer.h"

namespace sightline::square_lights {

/// The frame of a vertex's tables: the same when they are made and when they are read.
inline Frame3 vertex_frame(const Vec3& normal, const Vec3& tangent) { return frame_from_normal_tangent(normal, tangent); }

struct SelfVisibilityOptions {
  int resolution = 64;  ///< rays along an edge of the disk's square; a multiple of 32
  bool count_horizon = false;
};

/// Vertices of one rigid object, in the space of its tracer.
struct VertexSpans {
  std::span<const Vec3> position;
  std::span<const Vec3> normal;            ///< unit shading normals: the axis of the tables
  std::span<const Vec3> tangent;           ///< may be zero vectors
  std::span<const Vec3> geometric_normal;  ///< unit: rays start off the surface on this side, by `error`
  std::span<const float> error;            ///< bound on a position's error, per component
};

/// Bytes that the result takes; announced before it is made.
std::uint64_t self_visibility_bytes(std::size_t vertices);
/// One table a vertex, one after the other. Rays that start below the tangent plane of the geometric normal count as hidden. Reports
/// progress, stops when cancelled; the same for any number of threads.
AlignedVector<std::int8_t> bake_self_visibility(const Tracer& tracer, const VertexSpans& vertices, const SelfVisibilityOptions& options,
                                                RayCounts& rays, const Context& context);

}  // namespace sightline::square_lights
