// `sightline bench fragments`: the fragments method beside its predecessors and Monte Carlo over the standard views.
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

struct FragmentBenchOptions {
  std::filesystem::path data;      ///< see load_bench_view
  std::filesystem::path cache;     ///< folder of reference pictures that are kept; empty = they are not
  std::vector<std::string> views;  ///< instead of each part's own
  std::vector<std::string> parts;  ///< of fragment_bench_parts(); empty = all
  std::optional<IVec2> size_px;    ///< instead of the views' own 1280x960, and of 640x480 along the path
  int truth_samples = 0;           ///< shadow rays a pixel of the reference picture; 0 = 4096
  int rounds = 0;                  ///< that times are the median of; 0 = 3
  bool strip = false;              ///< the caller wants the strip of the results
  bool quick = false;              ///< small pictures, few samples and rounds: not to be quoted
};

/// table, curve, sizes, interactive, temporal.
std::vector<std::string> fragment_bench_parts();

/// Measures in this process. Views whose files are missing are left out with a warning. When cancelled, what is complete by then is
/// returned, with "interrupted": true.
BenchResults run_fragment_bench(const FragmentBenchOptions& options, const Context& context);
/// The results as Markdown tables.
std::string fragment_bench_markdown(const nlohmann::ordered_json& results);
/// One page with tables, charts, fragment maps and error maps that needs no other file.
std::string fragment_bench_html(const BenchResults& results);

}  // namespace sightline
