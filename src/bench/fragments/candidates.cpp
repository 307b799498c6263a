#include "bench/fragments/candidates.h"

#include <fmt/format.h>

namespace sightline {

FragmentCandidate fragments_default() { return {"fragments", {}}; }
FragmentCandidate fragments_koa() { return {"as in the paper", {"variant=koa"}}; }
FragmentCandidate fragments_nichols(int threshold) {
  return {fmt::format("predecessor, {} of 64", threshold), {"variant=nichols", fmt::format("nichols_threshold={}", threshold)}};
}

const std::vector<FragmentCandidate>& fragment_ablations() {
  static const std::vector<FragmentCandidate> table = {
      {"fast", {"variant=fast"}},
      {"radial basis functions", {"upsample=rbf"}},
      {"the same, fixed variance", {"upsample=rbf-fixed"}},
      {"level by level", {"upsample=multipass"}},
      {"always four children", {"subdivide_twice=false"}},
      {"no additional samples", {"extra_samples=off"}},
      {"strict threshold", {"strict_threshold=on"}},
      {"64 rays a pixel", {"level0_rays=64"}},
      {"the same rays under small lights and large", {"rays_by_size=off"}},
      {"no early out", {"early_out=off"}},
      {"probes averaged", {"probes=off"}},
      {"no confirmation", {"confirm=0"}},
      {"borders not refined again", {"borders=0"}},
      {"no more rays in penumbrae", {"penumbra_level=8"}},
      {"not smoothed", {"smooth=off"}},
      {"irradiance interpolated", {"signal=irradiance"}},
  };
  return table;
}

RenderRequest fragments_request(const std::vector<std::string>& settings) {
  RenderRequest request;
  request.method = "fragments";
  request.settings = settings;
  request.spp = 1, request.max_bounces = 0;
  return request;
}

RenderRequest monte_carlo_request(int samples) {
  RenderRequest request;
  request.method = "reference";
  request.spp = 1, request.light_samples = samples, request.max_bounces = 0;
  return request;
}

}  // namespace sightline
