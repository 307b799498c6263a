// Fits a linearly transformed cosine to a slice of the GGX lobe.
#pragma once

#include <array>
#include <span>

#include "shade/ggx.h"

namespace sightline::fit {

/// The inverse of the transform, [[m11, 0, m13], [0, 1, 0], [m31, 0, m33]], in coordinates where z is the normal and wo lies in the xz
/// plane with x >= 0.
struct InverseTransform {
  double m11 = 1, m13 = 0, m31 = 0, m33 = 1;
};
/// What the transform tends to for a mirror: the half vector's slopes, to first order around the mirror direction.
InverseTransform mirror_transform(double cosine, double alpha);

/// The transformed cosine at unit w, with a sign; integrates to 1 over z > 0.
double ltc_value(const InverseTransform& m, const Vec3d& w);

/// Integrals over wi of f cos for F = 1, (1 - cos)^5 and cos (1 - cos)^6, the cosine being that at the micro-facet.
std::array<double, 3> lobe_energies(double cosine, double alpha, int resolution);

struct LobeFit {
  InverseTransform transform;
  double energy;           ///< for F = 1
  double total_variation;  ///< half the integral of |f cos / energy - fit|: no polygon's share is wrong by more
};
/// Starts at each of the guesses. `exponent`: of the error that is made small, 3 in [Heitz2016].
LobeFit fit_lobe(double cosine, double alpha, std::span<const InverseTransform> guesses, double exponent);
/// Half the integral of |f cos / energy - density| for a transform that comes from elsewhere.
double total_variation(double cosine, double alpha, const InverseTransform& m);

}  // namespace sightline::fit
