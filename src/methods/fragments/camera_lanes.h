// What the camera pass does to every hit alike, 16 at a time.
#pragma once

#include <cstddef>
#include <cstdint>

#include "trace/ray_batch.h"
#include "world/surface.h"

namespace sightline {

/// Turns the normals of hits [0, count) to the side that the ray came from, and sets back[i] = 1 where that was the back. Shading normals
/// give way to geometric ones where they do not see the camera on the side on which those do. Hits of rays that hit nothing move to
/// infinity. Writes whole groups of kLanes.
void turn_normals(const Vec3Batch& direction, std::size_t count, SurfaceBatch& surfaces, HitBatch& hits, std::uint8_t* back);

}  // namespace sightline
