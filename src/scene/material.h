// Materials as scene files describe them: a reflectance model with textured parameters, and what all models share.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "base/math/vec.h"
#include "scene/ids.h"
#include "scene/texture.h"

namespace sightline {

class MeasuredReflectance;  // shade/measured_reflectance.h

/// Lambertian reflection.
struct DiffuseMaterial {
  ColorParam reflectance{0.7f};
};
/// glTF metallic-roughness: GGX over Lambert with Schlick's Fresnel. alpha = roughness².
struct MetallicRoughnessMaterial {
  ColorParam base_color{1.f};
  FloatParam metallic{1.f}, roughness{1.f};
};
/// Metal with complex index of refraction eta + i k per channel; roughness values are GGX alphas; 0 = mirror.
struct ConductorMaterial {
  ColorParam eta{0.2f}, k{3.9f};
  ColorParam reflectance_tint{1.f};
  FloatParam alpha_u{0.f}, alpha_v{0.f};
  bool remap_roughness = false;  ///< alpha = sqrt(roughness) as pbrt-v4 does
};
/// Smooth (alpha 0) or rough dielectric interface; `eta` = interior over exterior index.
struct DielectricMaterial {
  float eta = 1.5f;
  FloatParam alpha_u{0.f}, alpha_v{0.f};
  bool remap_roughness = false;
  bool thin = false;  ///< a slab: transmission goes straight on (pbrt thindielectric)
};
/// Lambert below a dielectric coat, as one analytic model with exact evaluate and pdf.
struct CoatedDiffuseMaterial {
  ColorParam reflectance{0.5f};
  float eta = 1.5f;
  FloatParam alpha_u{0.f}, alpha_v{0.f};
  bool remap_roughness = false;
};
/// Normalised Phong lobe over Lambert (OBJ/MTL).
struct PhongMaterial {
  ColorParam diffuse{0.5f}, specular{0.f};
  FloatParam exponent{32.f};
};
/// Lambertian reflection and transmission.
struct DiffuseTransmissionMaterial {
  ColorParam reflectance{0.25f}, transmittance{0.25f};
};
/// Picks `second` with probability `amount`, else `first`, per shading point (pbrt mix).
struct MixMaterial {
  MaterialId first, second;
  FloatParam amount{0.5f};
};
/// No surface: rays pass (pbrt "interface"); still separates media.
struct InterfaceMaterial {};
/// Ward's elliptical Gaussian lobe over Lambert; `alpha_x` along the tangent.
struct WardMaterial {
  ColorParam diffuse{0.1f}, specular{0.3f};
  FloatParam alpha_x{0.2f}, alpha_y{0.2f};
};
/// Cook–Torrance over Lambert: Beckmann's facets of rms slope `roughness`; `f0` is a facet's reflectance at normal incidence.
struct CookTorranceMaterial {
  ColorParam diffuse{0.2f}, specular{0.8f};
  FloatParam roughness{0.3f};
  ColorParam f0{0.04f};
};
/// Reflectance as it was measured; without data Lambert 0.7. Made by load_measured_material.
struct MeasuredMaterial {
  std::shared_ptr<const MeasuredReflectance> data;
  std::string file;                ///< where it came from, for messages
  std::uint64_t content_hash = 0;  ///< of the data
};

using SurfaceModel =
    std::variant<DiffuseMaterial, MetallicRoughnessMaterial, ConductorMaterial, DielectricMaterial, CoatedDiffuseMaterial, PhongMaterial,
                 DiffuseTransmissionMaterial, MixMaterial, InterfaceMaterial, WardMaterial, CookTorranceMaterial, MeasuredMaterial>;

enum class AlphaMode { opaque, mask, blend };

struct Material {
  std::string name;
  SurfaceModel model = DiffuseMaterial{};
  ColorParam emission{0.f};  ///< radiance, W/(sr·m²); black = no emitter
  bool emission_two_sided = false;
  TextureId normal_map;  ///< tangent-space normals, linear encoding
  float normal_scale = 1;
  TextureId bump;  ///< displacement in world units, along the shading normal
  float bump_scale = 1;
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha_cutoff = 0.5f;
  FloatParam alpha{1.f};
  bool two_sided = true;  ///< as the file says; rays see both sides all the same (trace/tracer.h)
  MediumId interior;      ///< absorbing medium behind the surface
};

/// Homogeneous medium that only absorbs: transmittance exp(-sigma_a d), sigma_a per world unit (Beer–Lambert).
struct Medium {
  std::string name;
  Color sigma_a{0};
};

}  // namespace sightline
