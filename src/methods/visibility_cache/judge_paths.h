// Candidates for virtual point lights from the eye's end: paths from the judges, connected to lights [Segovia2006].
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/core/context.h"
#include "methods/visibility_cache/vpl_candidates.h"

namespace sightline::vpl {

struct JudgePathOptions {
  int max_bounces = 8;  ///< surfaces of a path, the candidate's included
  std::uint32_t key = 0;
};

/// Paths [first, first + count), a candidate for each surface that a light was found from: it stands on the first surface, and its light
/// comes by way of the others. Without mirrors and glass. Candidate::beta is still to be divided by the density.
///
/// Deviation from [Segovia2006], where such candidates take their light from other virtual point lights: then no weight by the densities
/// of both ways would be known.
std::vector<Candidate> trace_judge_paths(const World& world, std::span<const Judge> judges, const JudgePathOptions& options,
                                         std::uint32_t first, std::size_t count, const Context& context, RayCounts& rays);

/// How many paths leave about `wanted` candidates, at most `most`.
std::size_t judge_paths_for(std::size_t wanted, std::size_t most, const World& world, std::span<const Judge> judges,
                            const JudgePathOptions& options, const Context& context, RayCounts& rays);

}  // namespace sightline::vpl
