// `sightline bench visibility-cache`: the visibility cache beside exact rays, shadow maps and NEE++ over the standard views.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/core/context.h"
#include "base/math/vec.h"
#include "bench/bench_results.h"

namespace sightline {

struct CacheBenchOptions {
  std::filesystem::path data;         ///< see load_bench_view
  std::vector<std::string> views;     ///< instead of each part's own
  std::vector<std::string> parts;     ///< of cache_bench_parts(); empty = all
  std::vector<double> ce;             ///< C_E of the curves; empty = 4, 8, 16, 36, 64
  std::vector<std::string> settings;  ///< name=value, of the curves' cached pictures
  std::vector<int> spp;               ///< samples a pixel of the curves; empty = 1, 9, 16
  std::optional<IVec2> size_px;       ///< instead of the views' own 1280x960
  bool strip = false;                 ///< the caller wants the strip of the results
  bool quick = false;                 ///< small pictures and few repetitions: not to be quoted
};

/// curves, rivals, lookup, flicker, ablations.
std::vector<std::string> cache_bench_parts();

/// Measures in this process. Views whose files are missing are left out with a warning. When cancelled, what is complete by then is
/// returned, with "interrupted": true.
BenchResults run_cache_bench(const CacheBenchOptions& options, const Context& context);
/// The results as Markdown tables.
std::string cache_bench_markdown(const nlohmann::ordered_json& results);
/// One page with tables, charts and pictures that needs no other file.
std::string cache_bench_html(const BenchResults& results);

}  // namespace sightline
