// Which materials reflect polygonal lights in closed form, and the lobes they have seen from one direction.
#pragma once

#include <optional>

#include "shade/analytic/ltc_lobe.h"
#include "shade/bsdf.h"

namespace sightline {

/// Lambert below, or beside, GGX. Covers what Bsdf::evaluate() covers: delta parts stay the caller's business (Bsdf::delta_lobes).
struct AnalyticBsdf {
  Color diffuse{0};           ///< reflectance of the Lambert part
  bool coated = false;        ///< the Lambert part is weakened by what GGX reflects, on the way in and out (see MetallicRoughness)
  bool has_specular = false;  ///< the GGX part is more than a delta
  Ggx ggx;                    ///< isotropic
  Color f0{0};                ///< Fresnel: f0 + (1 - f0) (1 - cos)^5 + metal cos (1 - cos)^6,
  Color metal{0};             ///< [Lazanyi2005]; exact at normal incidence, cos 1/7 and grazing
  Color scale{1};             ///< times this
};

/// Lambert, MetallicRoughness, isotropic Conductor, and Phong without its lobe; nothing for other models, which are left to sampling.
std::optional<AnalyticBsdf> analytic_form(const Bsdf& bsdf);

/// What multiplies three integrals over a polygon: the form factor, the form factor through diag(1 / stretch, 1 / stretch, 1), and the one
/// through the matrix of LtcLobe.
struct AnalyticLobes {
  Color diffuse{0}, wide{0}, specular{0};
  float stretch = 1;
  float m11 = 1, m13 = 0, m31 = 0, m33 = 1;
};

/// `cos_o`: cosine between wo and the normal; its sign does not matter.
AnalyticLobes analytic_lobes(const AnalyticBsdf& bsdf, float cos_o);

}  // namespace sightline
