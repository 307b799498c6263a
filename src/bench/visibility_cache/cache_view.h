// A standard view with the samples that its comparison takes, and pictures of it: exact and cached with the same samples.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/bench_shot.h"
#include "bench/visibility_cache/cache_bench.h"

namespace sightline {

struct CacheView : BuiltView {
  int light_samples = 64;  ///< of area lights and of the environment, an eye point
  int max_bounces = 0;     ///< above 0: with virtual point lights
  bool has_punctual = false;
  bool has_sampled = false;  ///< lights that are sampled: areas, environments
};

/// Nothing where the view's files are missing.
std::optional<CacheView> load_cache_view(const std::string& name, const CacheBenchOptions& options, const Context& context);

struct ShotRequest {
  std::string visibility = "cached";
  std::vector<std::string> settings;
  int spp = 1;
  int light_samples = 0;             ///< 0 = the view's
  std::optional<SampleRange> range;  ///< of spp
  bool direct_only = false;          ///< no virtual point lights
};

Shot shoot(const CacheView& view, const ShotRequest& request, const Context& context);

/// The pictures by turns (bench_shot.h).
std::vector<Shot> shoot_by_turns(const CacheView& view, const std::vector<ShotRequest>& requests, int rounds, const Context& context);

/// Pixels that count in errors: those whose samples of the range, of `spp`, all hit a surface that does not emit (docs/metrics.md).
std::vector<std::uint8_t> surface_mask(const CacheView& view, int spp, std::optional<SampleRange> range, const Context& context);

}  // namespace sightline
