// What is compared: the method with its variants and ablations, and Monte Carlo.
#pragma once

#include <string>
#include <vector>

#include "bench/bench_shot.h"

namespace sightline {

struct FragmentCandidate {
  std::string name;
  std::vector<std::string> settings;  ///< of the fragments method
};

/// As it is by default.
FragmentCandidate fragments_default();
/// The paper's own [Koa2017].
FragmentCandidate fragments_koa();
/// Its predecessor [Nichols2010], with a threshold of so many rays of 64.
FragmentCandidate fragments_nichols(int threshold);
/// Single choices undone, each against the default.
const std::vector<FragmentCandidate>& fragment_ablations();

/// One sample a pixel through its centre, direct light.
RenderRequest fragments_request(const std::vector<std::string>& settings);
/// `samples` stratified shadow rays a pixel on the same primary hits.
RenderRequest monte_carlo_request(int samples);

}  // namespace sightline
