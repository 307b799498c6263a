// Coarse meshes with smooth normals, shaded as the curved surface that the normals suggest (WorldOptions::shadow_terminator).
#pragma once

#include <cstddef>
#include <vector>

#include "trace/ray_batch.h"
#include "world/world.h"

namespace sightline {

/// Lifts hit points onto the curved surface [Hanika2021] and lets the interpolated normal decide which directions lie above it, so that
/// neither facets nor their horizons show where light begins to graze. One rule for all methods, and for rays, caches and maps alike. Left
/// as they are: points that emit, whose place is part of densities; surfaces that transmit, which have two sides; and points whose
/// interpolated normal does not see the viewer.
class ShadowTerminator {
 public:
  explicit ShadowTerminator(const World& world);

  /// Whether anything is to be done for these hits.
  static bool is_on(const SurfaceBatch& surfaces) { return !surfaces.shadow_offset.x.empty(); }
  bool applies(const RayBatch& rays, const SurfaceBatch& surfaces, std::size_t i) const;
  /// Where rays leave from. Clear of the facet by more than the error, since they may leave it downwards.
  static Vec3 lifted(const RayBatch& rays, const SurfaceBatch& surfaces, std::size_t i);

  /// For paths that are made from the eye alone: hits themselves are moved.
  void apply(const RayBatch& rays, SurfaceBatch& surfaces, std::size_t count) const {
    if (is_on(surfaces)) move(rays, surfaces, count);
  }

 private:
  void move(const RayBatch& rays, SurfaceBatch& surfaces, std::size_t count) const;

  std::vector<bool> reflects_;  ///< by material: and nothing else
};

}  // namespace sightline
