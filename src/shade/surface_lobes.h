// An opaque BSDF seen from one direction, as plain numbers: what vector code needs to evaluate it towards many others.
#pragma once

#include <array>
#include <cstdint>

#include "base/math/vec.h"
#include "shade/ggx.h"
#include "shade/ggx_albedo_table.h"

namespace sightline {

/// Lambert, alone or below a GGX interface, or the interface alone. Towards unit wi on wo's side, with t the interface's transmittance,
/// F its Fresnel term and D, G2 as in ggx.h:
///
///   f cos = base t(wi) cos / pi  +  tint F(wo·m) D(m) G2 / (4 |zo|)
///   pdf   = lambert_share cos / pi  +  ggx_share D(m) G1(wo) / (4 |zo|)
///
/// The scalar definitions are the models' own (coated_diffuse.h, conductor.h, lambert.h, metallic_roughness.h), vector code is in
/// surface_lobes-inl.h; tests compare the two.
struct SurfaceLobes {
  enum class Interface : std::uint8_t {
    none,        ///< Lambert alone
    dielectric,  ///< Fresnel's equations with a real index; t = 1 - Fresnel × albedo table
    conductor,   ///< with a complex index; nothing below
    schlick,     ///< t = 1 - f0 (first table) - (1 - f0) (second table)
  };
  Interface interface = Interface::none;
  bool has_ggx = false;  ///< else the interface's own reflection is a delta, or there is none
  Vec3 wo{0, 0, 1};      ///< local, on the upper side
  Color base{0};         ///< what Lambert reflects, with all that depends on wo alone
  Color tint{1};
  Color eta{1}, k{0};  ///< conductor; dielectric: eta.x
  Color f0{0};         ///< Schlick
  Ggx ggx;
  float lambert_share = 1, ggx_share = 0;
  /// Directional albedo of the interface at the cosines of ggx_table::cos_at, linear between them in the root of the cosine.
  using Nodes = std::array<float, ggx_table::kCosCount>;
  Nodes albedo{}, albedo_rest{};
};

}  // namespace sightline
