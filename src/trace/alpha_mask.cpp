#include "trace/alpha_mask.h"

#include <algorithm>

#include "trace/sphere.h"
#include "trace/triangle_uv.h"

namespace sightline {

AlphaMasks::AlphaMasks(const Scene& scene, const TextureSet& textures, bool enabled)
    : textures_(&textures), instance_mesh_(scene.instances.size(), kNone) {
  // Blended surfaces are masked at one half until blending is built. What can never fall below the cutoff needs no question.
  const auto mask_of = [&](MaterialId id) {
    Mask mask;
    if (!id.valid() || id.index >= scene.materials.size()) return mask;
    const Material& material = scene.materials[id.index];
    mask.is_interface = std::holds_alternative<InterfaceMaterial>(material.model);
    if (!enabled || material.alpha_mode == AlphaMode::opaque) return mask;
    const float cutoff = material.alpha_mode == AlphaMode::blend ? 0.5f : material.alpha_cutoff;
    if (!material.alpha.texture.valid() && material.alpha.value >= cutoff) return mask;
    mask.alpha = material.alpha, mask.cutoff = cutoff;
    return mask;
  };
  const auto is_masked = [](const Mask& mask) { return mask.cutoff > 0; };
  const auto is_interface = [](const Mask& mask) { return mask.is_interface; };

  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const Mesh& mesh = scene.meshes[instance.mesh.index];
    MaskedMesh masked;
    if (instance.material_override.valid()) {
      masked.palette.push_back(mask_of(instance.material_override));
    } else {
      for (const MaterialId id : mesh.materials) masked.palette.push_back(mask_of(id));
      masked.triangle_materials = mesh.triangle_materials;
    }
    masked.has_mask = std::any_of(masked.palette.begin(), masked.palette.end(), is_masked);
    masked.has_interface = std::any_of(masked.palette.begin(), masked.palette.end(), is_interface);
    if (!masked.has_mask && !masked.has_interface) continue;
    masked.uvs = mesh.uvs;
    masked.triangles = mesh.triangles;
    instance_mesh_[i] = static_cast<std::uint32_t>(meshes_.size());
    any_ = any_ || masked.has_mask;
    meshes_.push_back(std::move(masked));
  }
  for (const Sphere& sphere : scene.spheres) sphere_masks_.push_back(mask_of(sphere.material));
  if (std::any_of(sphere_masks_.begin(), sphere_masks_.end(), is_masked)) {
    spheres_ = scene.spheres;
    any_ = true;
  }
  any_interface_sphere_ = std::any_of(sphere_masks_.begin(), sphere_masks_.end(), is_interface);
}

bool AlphaMasks::is_hole(const Mask& mask, const Vec2& uv) const {
  // The finest level: a filtered mask would make a surface vanish or close up with distance.
  return mask.cutoff > 0 && textures_->sample(mask.alpha, TexturePoint{uv, {}, {}}) < mask.cutoff;
}

const AlphaMasks::Mask* AlphaMasks::mask_at(std::uint32_t instance, std::uint32_t primitive) const {
  if (instance_mesh_[instance] == kNone) return nullptr;
  const MaskedMesh& mesh = meshes_[instance_mesh_[instance]];
  const std::size_t entry = mesh.triangle_materials.empty() ? 0 : mesh.triangle_materials[primitive];
  return entry < mesh.palette.size() ? &mesh.palette[entry] : nullptr;
}

bool AlphaMasks::is_hole(std::uint32_t instance, std::uint32_t primitive, float u, float v) const {
  const Mask* mask = mask_at(instance, primitive);
  if (!mask || !(mask->cutoff > 0)) return false;
  const MaskedMesh& mesh = meshes_[instance_mesh_[instance]];
  return is_hole(*mask, interpolate_uv(corner_uvs(mesh.uvs, mesh.triangles[primitive]), u, v));
}

bool AlphaMasks::is_interface(std::uint32_t instance, std::uint32_t primitive) const {
  const Mask* mask = mask_at(instance, primitive);
  return mask && mask->is_interface;
}

bool AlphaMasks::is_sphere_hole(std::uint32_t sphere, const Vec3& point) const {
  if (spheres_.empty()) return false;
  return is_hole(sphere_masks_[sphere], sphere_uv(sphere_local_direction(spheres_[sphere], point)));
}

}  // namespace sightline
