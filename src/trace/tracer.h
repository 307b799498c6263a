// Finds what rays hit. Every acceleration structure implements this one interface.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "base/core/context.h"
#include "base/math/bounds.h"
#include "scene/scene.h"
#include "trace/placement.h"
#include "trace/ray_batch.h"

namespace sightline {

class TextureSet;

/// Bytes held, for the statistics and the memory budget.
struct TracerMemory {
  std::uint64_t acceleration_bytes = 0;  ///< hierarchy and what it copied
  std::uint64_t peak_build_bytes = 0;
};

/// What was built, and what an edit could take over.
struct TracerStatistics {
  std::uint64_t static_triangles = 0;     ///< in world space
  std::uint64_t instanced_triangles = 0;  ///< of the shared meshes, each counted once
  std::uint32_t instances = 0;
  std::uint32_t static_scenes_built = 0;  ///< 0 or 1
  std::uint32_t mesh_scenes_built = 0, mesh_scenes_shared = 0;
};

/// An immutable acceleration structure over one posed Scene. Safe to use from any thread. Alpha-masked surfaces (AlphaMode::mask, blend
/// at 0.5) are transparent to rays where the texture says so. Rays see every surface from both sides, also where Material::two_sided is
/// false: visibility stays symmetric, so that a shadow ray may be traced from either end; culling back faces is for whoever shades.
/// Rays have t_near >= 0.
class Tracer {
 public:
  virtual ~Tracer() = default;
  /// Closest hits in [t_near, t_far]; `hits` is resized to rays.size.
  virtual void intersect(const RayBatch& rays, HitBatch& hits, BatchKind kind, RayCounts& counts) const = 0;
  /// 1 where something lies in [t_near, t_far] that is more than an interface between media (InterfaceMaterial: closest hits report those);
  /// `occluded` has at least padded(rays.size) elements.
  virtual void occluded(const RayBatch& rays, std::span<std::uint8_t> occluded, BatchKind kind, RayCounts& counts) const = 0;
  virtual Bounds bounds() const = 0;
  virtual TracerMemory memory() const = 0;
  virtual TracerStatistics statistics() const = 0;
  /// The triangles that were traced: what (instance, primitive, u, v) of a hit refer to.
  virtual const Placement& placement() const = 0;
  virtual std::string_view name() const = 0;
};

/// How a World traces.
struct TracerOptions {
  bool robust = true;    ///< watertight Embree traversal (RTC_SCENE_FLAG_ROBUST)
  bool compact = false;  ///< less memory, slower
  bool alpha_masks = true;
  /// Of the memory budget: what later stages will hold, so that the build leaves it free.
  std::uint64_t reserved_bytes = 0;
  std::string isa;  ///< Embree's instruction set: sse2, sse4.2, avx, avx2, avx512; empty = the best there is
};

/// Tests every primitive: the truth that other structures are compared with. Keeps a reference to the scene's arrays.
std::unique_ptr<Tracer> make_brute_tracer(const Scene& scene, const TextureSet& textures, const TracerOptions& options,
                                          const Context& context);

/// Embree (3.13 or 4). Geometry used once and not animated is one static scene in world space; the rest are instances. `previous` (may be
/// null, must be an Embree tracer of an earlier version of the scene) lends the committed mesh scenes that did not change.
std::unique_ptr<Tracer> make_embree_tracer(const Scene& scene, const TextureSet& textures, const TracerOptions& options,
                                           const Context& context, const Tracer* previous = nullptr);

}  // namespace sightline
