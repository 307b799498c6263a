// Committed Embree scenes: built once, never modified, shared between the versions of a World.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "base/core/shared_array.h"
#include "scene/mesh.h"
#include "trace/embree/embree_device.h"
#include "trace/placement.h"

namespace sightline {

/// What hits of a geometry are asked.
struct HitFilter {
  bool holes = false;       ///< the alpha masks, at every hit
  bool interfaces = false;  ///< whether it lets shadow rays pass, at their hits
  HitFilter operator|(const HitFilter& o) const { return {holes || o.holes, interfaces || o.interfaces}; }
  /// Asks all that `o` asks.
  bool covers(const HitFilter& o) const { return (holes || !o.holes) && (interfaces || !o.interfaces); }
};

struct TriangleGeometry {
  SharedArray<Vec3> positions;
  SharedArray<UVec3> triangles;
  HitFilter filter;
};

/// Owns an RTCScene and whatever memory it shares.
class CommittedScene {
 public:
  explicit CommittedScene(std::shared_ptr<EmbreeDevice> device);
  ~CommittedScene();
  CommittedScene(const CommittedScene&) = delete;
  CommittedScene& operator=(const CommittedScene&) = delete;

  RTCScene get() const { return scene_; }
  std::uint64_t bytes() const { return bytes_; }
  std::uint64_t triangle_count() const;
  /// Whether it can stand for these geometries: same arrays in the same order, and filters at least where they are needed.
  bool serves(std::span<const TriangleGeometry> geometries) const;

 private:
  friend class SceneCommitter;
  std::shared_ptr<EmbreeDevice> device_;
  RTCScene scene_ = nullptr;
  std::vector<TriangleGeometry> geometries_;
  std::vector<std::shared_ptr<const CommittedScene>> instanced_;
  std::uint64_t bytes_ = 0;
};

/// An instance in the top-level scene.
struct InstanceGeometry {
  std::shared_ptr<const CommittedScene> mesh;
  Mat4 world_from_object{1};
};

/// Builds the scenes of one tracer and reports their common progress.
class SceneCommitter {
 public:
  SceneCommitter(std::shared_ptr<EmbreeDevice> device, EmbreeDevice::Build& build, bool robust, bool compact,
                 std::uint64_t total_triangles);

  std::shared_ptr<const CommittedScene> commit_triangles(std::vector<TriangleGeometry> geometries);
  /// Instances take the geometry ids 0, 1, ...; the spheres follow as one geometry whose primitives have the scene's order.
  std::shared_ptr<const CommittedScene> commit_top(std::span<const InstanceGeometry> instances, std::span<const Sphere> spheres,
                                                   HitFilter sphere_filter);

 private:
  void commit(CommittedScene& scene, std::uint64_t triangle_count);
  static bool on_progress(void* self, double fraction);

  std::shared_ptr<EmbreeDevice> device_;
  EmbreeDevice::Build& build_;
  bool robust_, compact_;
  double total_triangles_, done_triangles_ = 0, current_triangles_ = 0;
};

}  // namespace sightline
