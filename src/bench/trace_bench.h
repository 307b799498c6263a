// `sightline bench trace`: the Tracer against bare Embree, and the reference method against the bare loop.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/core/context.h"
#include "base/math/vec.h"
#include "bench/bench_results.h"

namespace sightline {

struct TraceBenchOptions {
  std::filesystem::path data;      ///< where real scenes are; views without their files are left out
  std::vector<std::string> views;  ///< none: sponza-court, dragon-room, hairball-room
  std::vector<std::string> parts;  ///< of trace_bench_parts(); none: all
  std::optional<IVec2> size_px;    ///< instead of the views' own 1280x960
  /// That times are the median of. 0: five for rays and three for pictures; where these take long, three and one.
  int rounds = 0;
  bool quick = false;  ///< small pictures and few rounds: not to be quoted
};

std::vector<std::string> trace_bench_parts();

/// Measures in this process, the two sides of every ratio by turns.
BenchResults run_trace_bench(const TraceBenchOptions& options, const Context& context);
/// Results as Markdown tables.
std::string trace_bench_markdown(const nlohmann::ordered_json& results);

}  // namespace sightline
