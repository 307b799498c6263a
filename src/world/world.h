// A scene that can be traced and shaded: tracer, lights and textures, built once and then immutable.
#pragma once

#include <memory>
#include <span>

#include "base/core/context.h"
#include "scene/scene.h"
#include "shade/light_table.h"
#include "texture/texture_set.h"
#include "trace/tracer.h"
#include "world/surface.h"

namespace sightline {

struct WorldOptions {
  enum class Backend { embree, brute } backend = Backend::embree;
  TracerOptions tracer;
  /// Fills SurfaceBatch::shadow_offset, with which methods shade coarse meshes as the curved surface that their normals suggest
  /// (methods/shadow_terminator.h). Off by default: it trades the facets' true shadows for smooth ones, and pictures show the scene as it
  /// is.
  bool shadow_terminator = false;
};

/// Immutable; safe to share between threads. Keeps its Scene.
class World {
 public:
  /// Materialises mesh sources (within the memory budget, else Error{resource}), then builds tracer, textures and light table. `scene`
  /// must already be posed.
  static std::shared_ptr<const World> build(Scene scene, const WorldOptions& options, const Context& context);
  /// A World of the edited scene that shares with `previous` all that the edit did not touch (mesh scenes by array identity, textures,
  /// lights). Moving a static mesh promotes it to an instance, with one rebuild of the static part.
  static std::shared_ptr<const World> edit(const World& previous, Scene scene, const Context& context);
  ~World();

  const Scene& scene() const;
  const Tracer& tracer() const;
  const TextureSet& textures() const;
  const LightTable& lights() const;
  Bounds bounds() const;
  bool shadow_terminator() const;
  std::uint64_t acceleration_bytes() const;
  /// Equal for Worlds made from each other by edits that moved neither surfaces nor lights (but cameras, say): what two points see of each
  /// other in one, they see in the other. Who keeps it can tell later, however many Worlds have come and gone. Never null; edits may give a
  /// new one where the old would do.
  const std::shared_ptr<const void>& shadows() const;

  /// Positions, normals, error bounds and materials of hits. `spread` (may be empty) is the width of each ray's cone at its origin and
  /// per unit length, used for texture footprints.
  void surfaces(const RayBatch& rays, const HitBatch& hits, SurfaceBatch& surfaces) const;
  /// uv, derivatives, frame and texture footprint of one hit; `cone_width` is the ray cone's diameter at the hit in world units.
  SurfaceDetail detail(const RayBatch& rays, const HitBatch& hits, std::size_t i, float cone_width) const;

 private:
  struct Impl;
  explicit World(std::unique_ptr<const Impl> impl);
  std::unique_ptr<const Impl> impl_;
};

}  // namespace sightline
