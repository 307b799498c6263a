// The parts of `sightline bench trace`: kinds of rays through the Tracer and through bare Embree; pictures by the reference and by bare
// loops.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "base/core/context.h"
#include "bench/bare_loop.h"
#include "bench/trace_bench.h"
#include "film/view.h"
#include "world/world.h"

namespace sightline {

/// A view of static triangles with one rectangle light, ready to be measured. Not to be moved: the job points to the view.
struct TraceStage {
  std::string name;
  std::shared_ptr<const World> world;
  Camera camera;
  IVec2 size_px{0};
  View view;  ///< rays through pixel centres
  BareJob job;

  /// Throws Error{usage} where the view has instances or spheres, or no rectangle light.
  TraceStage(std::string view_name, std::shared_ptr<const World> built, const Camera& from, IVec2 size);
  TraceStage(const TraceStage&) = delete;
  TraceStage& operator=(const TraceStage&) = delete;
};

/// Each appends a row as it is done.
void trace_rays(const TraceStage& stage, const TraceBenchOptions& options, nlohmann::ordered_json& rows, const Context& context);
void trace_pictures(const TraceStage& stage, const TraceBenchOptions& options, nlohmann::ordered_json& rows, const Context& context);

/// All ways to call Embree that the Tracer could choose from.
inline constexpr std::array<CallStyle, 5> kCallStyles = {{{1, false}, {8, false}, {8, true}, {16, false}, {16, true}}};
std::string text(CallStyle style);

/// Seconds of each candidate, round by round; every round begins with another one, so that none always follows the same neighbour.
std::vector<std::vector<double>> by_turns(const std::vector<std::function<double()>>& candidates, int rounds, const Context& context);

/// Call styles by speed, from short runs by turns: least seconds of each in a few rounds, and of the two best in some more.
struct StyleRanking {
  std::vector<std::size_t> order;  ///< of kCallStyles, the fastest first
  std::array<double, kCallStyles.size()> seconds{};
};
StyleRanking rank_styles(const std::function<double(CallStyle)>& run, bool quick, const Context& context);

}  // namespace sightline
