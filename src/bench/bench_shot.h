// Pictures of a standard view, timed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/bench_views.h"
#include "session/render.h"
#include "world/world.h"

namespace sightline {

/// A standard view ready to be rendered.
struct BuiltView {
  std::string name;
  std::shared_ptr<const World> world;
  Camera camera;
  IVec2 size_px{0};
};
/// `size_px` instead of the view's own, of which `quick` takes an eighth. Nothing, with a warning, where the view's files are missing.
std::optional<BuiltView> load_built_view(const std::string& name, const std::filesystem::path& data, std::optional<IVec2> size_px,
                                         bool quick, const Context& context);

/// A finished picture; its time is that of its passes.
struct Shot {
  ColorImage image;
  double seconds = 0;
  PassStatistics statistics;
  double prepare_seconds = 0;  ///< before the first pass: bakes found or made
};
/// Throws Error{interrupted} instead of returning a picture that is not complete.
Shot shoot(const BuiltView& view, const RenderRequest& request, const Context& context);

/// Pictures 0 to count - 1 by turns, each with the median of its times over the rounds: one, or three where `rounds` is 0 and the first
/// takes under ten seconds. `picture` of the first round is kept.
std::vector<Shot> shoot_by_turns(std::size_t count, int rounds, const std::function<Shot(std::size_t)>& picture);

/// Pixels that count in errors: those whose samples all hit a surface that does not emit (docs/metrics.md). `request` says which samples.
std::vector<std::uint8_t> surface_mask(const BuiltView& view, RenderRequest request, const Context& context);

}  // namespace sightline
