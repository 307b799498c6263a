// The directional albedo of a BSDF by quadrature: what a surface in a uniformly white world looks like.
#pragma once

#include "shade/bsdf.h"

namespace sightline {

/// Integrals of f |cos wi| over wi, by part, with the integral of the density.
struct DirectionalAlbedo {
  Color reflected{0}, transmitted{0};              ///< parts that evaluate() covers
  Color delta_reflected{0}, delta_transmitted{0};  ///< parts that only sample() knows
  float density = 0;                               ///< integral of the pdf: the probability of a sample that is not a delta's

  Color total() const { return reflected + transmitted + delta_reflected + delta_transmitted; }
};

/// Exact to about `tolerance`; tens of thousands of evaluations for narrow lobes: meant for tests and tables.
DirectionalAlbedo integrate_directional_albedo(const Bsdf& bsdf, const Vec3& wo, TransportMode mode = TransportMode::radiance,
                                               float tolerance = 1e-5f);

}  // namespace sightline
