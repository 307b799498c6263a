// How much a GGX surface reflects in all: what models with a layer below need to know so that light is shared, not invented.
#pragma once

#include "base/math/vec.h"
#include "shade/ggx.h"
#include "shade/surface_lobes.h"

namespace sightline {

/// Relative index of refraction up to which the tables of dielectric albedo reach.
inline constexpr float kGgxAlbedoMaxEta = 3;

/// Directional albedo of the reflection by a dielectric GGX surface seen from outside at `cos_theta` >= 0, single scattering; 1 <= eta <=
/// kGgxAlbedoMaxEta. Exact if smooth, else interpolated in a table that errs upwards, by at most 0.012 (0.04 for cosines below 0.1). An
/// anisotropic surface counts as the isotropic one of the same mean slope area.
float ggx_dielectric_albedo(float cos_theta, const Ggx& ggx, float eta);
/// Its mean under uniform light (cosine-weighted).
float ggx_dielectric_mean_albedo(const Ggx& ggx, float eta);

/// The same for a GGX surface with Schlick's Fresnel.
Color ggx_schlick_albedo(const Color& f0, float cos_theta, const Ggx& ggx);
Color ggx_schlick_mean_albedo(const Color& f0, const Ggx& ggx);

/// The tables' entries for one surface, for code that looks up many cosines: of the dielectric albedo over Fresnel's reflectance, and the
/// parts that f0 and 1 - f0 multiply. Not for smooth surfaces.
SurfaceLobes::Nodes ggx_dielectric_albedo_nodes(const Ggx& ggx, float eta);
void ggx_schlick_albedo_nodes(const Ggx& ggx, SurfaceLobes::Nodes& f0_part, SurfaceLobes::Nodes& rest);

/// The numbers behind the tables, by quadrature: how they were made, and what they are tested against. For Schlick's Fresnel the albedo is
/// f0 x + (1 - f0) y.
float integrate_ggx_dielectric_albedo(float cos_theta, float alpha, float eta, int resolution);
Vec2 integrate_ggx_schlick_albedo(float cos_theta, float alpha, int resolution);

}  // namespace sightline
