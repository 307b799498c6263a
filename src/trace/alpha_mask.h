// Where surfaces let rays pass: holes of alpha masks for all rays, interfaces of media for shadow rays.
#pragma once

#include <cstdint>
#include <vector>

#include "base/core/shared_array.h"
#include "scene/scene.h"
#include "texture/texture_set.h"
#include "trace/ray_batch.h"

namespace sightline {

/// Answers for one scene whether a hit lies in a hole. Immutable; refers to the TextureSet, which must outlive it.
class AlphaMasks {
 public:
  AlphaMasks(const Scene& scene, const TextureSet& textures, bool enabled);

  /// Whether hits on this instance (or any sphere) need asking at all.
  bool masked(std::uint32_t instance) const { return instance_mesh_[instance] != kNone && meshes_[instance_mesh_[instance]].has_mask; }
  bool any_sphere() const { return !spheres_.empty(); }
  /// The same for hits of shadow rays, which interfaces do not stop.
  bool has_interface(std::uint32_t instance) const {
    return instance_mesh_[instance] != kNone && meshes_[instance_mesh_[instance]].has_interface;
  }
  bool any_interface_sphere() const { return any_interface_sphere_; }
  bool any() const { return any_; }
  /// Whether triangle `primitive` of `instance` has a hole at barycentrics (u, v).
  bool is_hole(std::uint32_t instance, std::uint32_t primitive, float u, float v) const;
  /// The same for a point on a sphere.
  bool is_sphere_hole(std::uint32_t sphere, const Vec3& point) const;
  /// Whether triangle `primitive` of `instance` only bounds a medium.
  bool is_interface(std::uint32_t instance, std::uint32_t primitive) const;
  bool is_sphere_interface(std::uint32_t sphere) const { return any_interface_sphere_ && sphere_masks_[sphere].is_interface; }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  struct Mask {
    FloatParam alpha;
    float cutoff = 0;  // <= 0: opaque
    bool is_interface = false;
  };
  struct MaskedMesh {
    SharedArray<Vec2> uvs;
    SharedArray<UVec3> triangles;
    SharedArray<std::uint16_t> triangle_materials;
    std::vector<Mask> palette;  // of the mesh, overrides applied; never empty
    bool has_mask = false, has_interface = false;
  };
  const Mask* mask_at(std::uint32_t instance, std::uint32_t primitive) const;
  bool is_hole(const Mask& mask, const Vec2& uv) const;

  const TextureSet* textures_;
  bool any_ = false, any_interface_sphere_ = false;
  std::vector<std::uint32_t> instance_mesh_;  // into meshes_, or kNone
  std::vector<MaskedMesh> meshes_;
  std::vector<Sphere> spheres_;  // all of the scene's if any is masked, else empty
  std::vector<Mask> sphere_masks_;
};

}  // namespace sightline
