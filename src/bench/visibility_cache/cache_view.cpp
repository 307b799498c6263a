#include "bench/visibility_cache/cache_view.h"

#include <utility>

namespace sightline {
namespace {

// Indirect bounces of the views that are lit by virtual point lights too; the others show direct light.
int bounces_of(const BuiltView& view) {
  if (view.name == "hairball-open") return 1;
  if (view.name == "kitchen-vpl") return view.world->scene().hints.max_bounces.value_or(8);
  return 0;
}

}  // namespace

std::optional<CacheView> load_cache_view(const std::string& name, const CacheBenchOptions& options, const Context& context) {
  std::optional<BuiltView> built = load_built_view(name, options.data, options.size_px, options.quick, context);
  if (!built) return std::nullopt;
  CacheView view{std::move(*built)};
  view.max_bounces = bounces_of(view);
  const LightTable& lights = view.world->lights();
  view.has_punctual = !lights.subset(LightSubset::kPunctual).empty();
  view.has_sampled = !lights.subset(LightSubset::kArea).empty() || !lights.subset(LightSubset::kEnvironment).empty();
  return view;
}

Shot shoot(const CacheView& view, const ShotRequest& request, const Context& context) {
  RenderRequest render_request;
  render_request.method = "visibility-cache";
  render_request.visibility = request.visibility;
  render_request.settings = request.settings;
  render_request.spp = request.spp;
  render_request.light_samples = request.light_samples > 0 ? request.light_samples : view.light_samples;
  render_request.max_bounces = request.direct_only ? 0 : view.max_bounces;
  render_request.sample_range = request.range;
  return shoot(view, render_request, context);
}

std::vector<Shot> shoot_by_turns(const CacheView& view, const std::vector<ShotRequest>& requests, int rounds, const Context& context) {
  return shoot_by_turns(requests.size(), rounds, [&](std::size_t i) { return shoot(view, requests[i], context); });
}

std::vector<std::uint8_t> surface_mask(const CacheView& view, int spp, std::optional<SampleRange> range, const Context& context) {
  RenderRequest request;
  request.method = "visibility-cache";
  request.visibility = "exact";
  request.spp = spp, request.light_samples = 1, request.max_bounces = 0;
  request.sample_range = range;
  return surface_mask(view, std::move(request), context);
}

}  // namespace sightline
