// Triangle hits of world-space meshes, 16 at a time: what surface_batch.cpp computes for most hits of most scenes.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/core/aligned.h"
#include "world/surface.h"
#include "world/surface_records.h"

namespace sightline {

/// Corners and shading normals of 16 triangles, gathered. Lanes not in `active` hold anything.
struct alignas(kCacheLine) TriangleLanes {
  float p[3][3][kLanes];  ///< corner, axis, lane
  float n[3][3][kLanes];
  float winding[kLanes];
  std::uint16_t active = 0;  ///< bit i: lane i is to be computed
  std::uint16_t smooth = 0;  ///< bit i: it has shading normals
};

/// Gathers the triangles of one instance (InstanceRecord::gathers) into the lanes of `mask`, which it makes active.
void gather_lanes(const InstanceRecord& record, const std::uint32_t* primitives, std::uint16_t mask, TriangleLanes& lanes);
/// Writes what a material says of a hit to the lanes of `mask` of [begin, begin + 16), without emission.
void set_material_lanes(const MaterialRecord& material, std::uint16_t mask, std::size_t begin, SurfaceBatch& surfaces);

/// Writes position, error and both normals of the active lanes of [begin, begin + 16) and returns those that must be done by the
/// scalar definition (reconstruct_triangle): near an edge, or with a normal out of the range of float products.
std::uint16_t reconstruct_lanes(const TriangleLanes& lanes, const float* u, const float* v, std::size_t begin, SurfaceBatch& surfaces);

}  // namespace sightline
