// The scene as the method sees it: rigid objects, and the vertices at which they are lit.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "bake/recent_values.h"
#include "methods/square_lights/shading_geometry.h"

namespace sightline::square_lights {

/// Objects where they are now, and their geometry.
class ShadingScene {
 public:
  /// Meshes without normals are flat, so each corner of theirs is a vertex of its own. Throws Error{usage} where a moving node scales
  /// differently along different axes: squares would not stay squares. Geometry that `recent` (may be null) has is taken from there.
  explicit ShadingScene(const World& world, RecentValues* recent = nullptr);

  const std::vector<ShadingObject>& objects() const { return objects_; }
  const ShadingVertices& vertices() const { return geometry_->vertices(); }
  /// Vertices in the order in which they are best lit (ShadingGeometry::order).
  const std::vector<std::uint32_t>& order() const { return geometry_->order(); }
  /// Object of a hit's instance (kSphereBit allowed).
  std::uint32_t object_of(std::uint32_t instance) const { return geometry_->object_of(instance); }
  /// Vertices of hit `i`; `position` in world space is read for spheres only.
  VertexHit vertices_of(const HitBatch& hits, std::size_t i, const Vec3& position) const {
    return geometry_->vertices_of(hits, i, position);
  }
  bool any_moving() const;
  /// Of the geometry, while this scene or `recent` holds it: what else hangs on it can be kept under this key.
  const std::array<std::uint64_t, 2>& key() const { return key_; }

 private:
  std::vector<ShadingObject> objects_;
  std::array<std::uint64_t, 2> key_{};
  std::shared_ptr<const ShadingGeometry> geometry_;
};

/// A scene of one object alone, in its own space, for a tracer: what bakes of it are made from. `position_scale` etc. are left as they are.
Scene object_scene(const Scene& scene, const ShadingObject& object);

}  // namespace sightline::square_lights
