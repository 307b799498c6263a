// Area lights nearby, cut into patches that each receiver sees as square lights.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/math/vec.h"
#include "methods/square_lights/square_light.h"
#include "scene/scene.h"
#include "shade/light_table.h"
#include "texture/texture_set.h"

namespace sightline::square_lights {

/// A parallelogram center + a half_u + b half_v, a and b in [-1, 1], that emits along cross(half_u, half_v).
struct AreaPatch {
  Vec3 center{0}, half_u{0}, half_v{0};
  Color radiance{0};
  bool two_sided = false;

  float area() const { return 4 * glm::length(glm::cross(half_u, half_v)); }
};

/// A patch from one receiver: direction, half diagonal and radiance, and how far away it is. What lies beyond hides nothing of it. A patch
/// seen from behind has radius 0.
struct PatchLight {
  SquareLight light;
  float distance = 0;
};

/// The patch as a receiver at `position` sees it: with its exact solid angle, around the mean direction to it.
PatchLight patch_light(const AreaPatch& patch, const Vec3& position);

/// One emitter: a rectangle, a disk, a sphere, or the emissive part of a mesh.
class LocalLight {
 public:
  LocalLight() = default;
  /// About `patches` patches, as square as may be. Triangles become parallelograms of the same area and centroid.
  static LocalLight rectangle(const RectangleLight& light, int patches);
  static LocalLight disk(const DiskLight& light, int patches);
  /// What is seen of a sphere is a disk of directions, wherever from: it is cut anew for each receiver.
  static LocalLight sphere(const SphereLight& light, int patches);
  /// Any surfaces. With more of them than `patches`, neighbours that face the same way are gathered into one square: its area is what they
  /// show along their mean normal, its radiance keeps their power.
  static LocalLight pieces(std::span<const AreaPatch> pieces, int patches);

  /// A sphere around the emitter.
  const Vec3& center() const { return center_; }
  float radius() const { return radius_; }
  bool is_sphere() const { return sphere_edge_ > 0; }
  /// Square lights a receiver gets, always as many.
  std::size_t count() const { return sphere_edge_ > 0 ? sphere_edge_ * sphere_edge_ : patches_.size(); }
  std::span<const AreaPatch> patches() const { return patches_; }
  /// Fills `lights` (of size count()) for a receiver.
  void lights_at(const Vec3& position, std::span<PatchLight> lights) const;
  /// The emitter carried along by rotation, translation and scale.
  LocalLight transformed(const Mat4& to_from_here) const;

 private:
  void bound();

  std::vector<AreaPatch> patches_;
  std::size_t sphere_edge_ = 0;  ///< of a sphere: its disk has this many patches squared
  Color sphere_radiance_{0};
  Vec3 center_{0};
  float radius_ = 0;
};

/// All area lights of a scene that stands as posed: light shapes, emissive meshes (one light an instance), emissive spheres. Textures of
/// emission count by their mean.
std::vector<LocalLight> collect_local_lights(const Scene& scene, const LightTable& lights, const TextureSet& textures, int patches);

}  // namespace sightline::square_lights
