// Principal components of a few hundred or thousand tables.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/core/aligned.h"
#include "methods/square_lights/distance_table.h"

namespace sightline::square_lights {

/// Tables of one cluster are near mean + sum of weights times vectors.
struct Components {
  AlignedVector<float> mean;     ///< kTableCells
  AlignedVector<float> vectors;  ///< [vector][cell]: orthonormal, of falling importance; those that the tables do not span are 0
};

/// Mean and the first `count` eigenvectors of the covariance of the tables whose numbers are `members`, by subspace iteration that starts
/// from `components.vectors`, where there are any, so that it never fits worse than those.
void fit_components(std::span<const std::int8_t> tables, std::span<const std::uint32_t> members, std::size_t count, int sweeps,
                    Components& components);

}  // namespace sightline::square_lights
