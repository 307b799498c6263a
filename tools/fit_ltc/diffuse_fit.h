// Fits the albedo that a diffuse layer feels above it by a constant and a stretched cosine lobe.
#pragma once

namespace sightline::fit {

struct DiffuseFit {
  double stretch, mean_full, mean_schlick, amount_full, amount_schlick;  ///< columns of ltc_table::kDiffuse
  double worst;  ///< largest error of 1 - E for a dielectric of F0 = 0.04, cosine-weighted share of the sky below 1e-3 left out
};
DiffuseFit fit_diffuse(double alpha);

}  // namespace sightline::fit
