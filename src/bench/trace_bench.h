// `sightline bench trace`: the Tracer against bare Embree, and the reference method against the bare loop.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/core/context.h"
#include "base/math/vec.h"

namespace sightline {

struct TraceBenchOptions {
  std::filesystem::path data;  ///< where real scenes are; views without their files are left out
  std::vector<std::string> views = {"dragon-room", "sponza-court", "hairball-room"};
  std::optional<IVec2> size_px;  ///< instead of the views' own 1280x960
  bool quick = false;            ///< small pictures and few rounds: not to be quoted
};

/// Measures in this process, the two sides of every ratio by turns. Results as JSON.
nlohmann::ordered_json run_trace_bench(const TraceBenchOptions& options, const Context& context);
/// The same as Markdown tables.
std::string trace_bench_markdown(const nlohmann::ordered_json& results);

}  // namespace sightline
