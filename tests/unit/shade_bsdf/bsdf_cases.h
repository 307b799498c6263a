// The BSDFs and directions that every property is tested on.
#pragma once

#include <string>
#include <vector>

#include "shade/bsdf.h"

namespace sightline::test {

struct BsdfCase {
  std::string name;
  Bsdf bsdf;
  bool narrow = false;  ///< the lobe is too narrow for an even grid
};

/// One or more of each model; all with a part that is not a delta.
std::vector<BsdfCase> rough_cases();
/// Mirrors and smooth glass.
std::vector<BsdfCase> delta_cases();
std::vector<BsdfCase> all_cases();

/// Normal, oblique, grazing, and from below.
std::vector<Vec3> outgoing_directions();

Vec3 direction_at(float cos_theta, float phi);

/// A blue paint with a gloss, as if it had been measured.
const MeasuredReflectance& measured_paint();

}  // namespace sightline::test
