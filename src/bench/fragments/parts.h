// The parts of the fragments benchmark: each measures one view and gives one JSON object.
#pragma once

#include "bench/bench_shot.h"
#include "bench/fragments/fragment_bench.h"

namespace sightline {

/// The paper's Table 1 [Koa2017, Tab. 1] with ablations: fragments, rays by purpose, seconds by stage, errors.
nlohmann::ordered_json fragment_table(const BuiltView& view, const FragmentBenchOptions& options, std::vector<BenchPicture>& pictures,
                                      const Context& context);
/// Time and error of Monte Carlo over its number of samples, and what ours is worth on that scale.
nlohmann::ordered_json fragment_curve(const BuiltView& view, const FragmentBenchOptions& options, const Context& context);
/// Error over the size of the light, at constant power; null, with a warning, for scenes without a rectangle.
nlohmann::ordered_json fragment_sizes(const BuiltView& view, const FragmentBenchOptions& options, const Context& context);
/// Frames a second along a path of camera and light; a strip of frames unless there is one already.
nlohmann::ordered_json fragment_interactive(BuiltView view, const FragmentBenchOptions& options, std::optional<ColorImage>& strip,
                                            const Context& context);
/// Rays, frames a second and errors along the same path with the light at rest, with and without what the last picture knows.
nlohmann::ordered_json fragment_temporal(BuiltView view, const FragmentBenchOptions& options, const Context& context);

}  // namespace sightline
