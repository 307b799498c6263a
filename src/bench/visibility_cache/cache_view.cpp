#include "bench/visibility_cache/cache_view.h"

#include <fmt/format.h>

#include <utility>

#include "bench/visibility_cache/figures.h"

namespace sightline {
namespace {

constexpr double kCheapRoundSeconds = 10;

// Indirect bounces of the views that are lit by virtual point lights too; the others show direct light.
int bounces_of(const BenchView& view) {
  if (view.name == "hairball-open") return 1;
  if (view.name == "kitchen-vpl") return view.scene.hints.max_bounces.value_or(8);
  return 0;
}

}  // namespace

std::optional<CacheView> load_cache_view(const std::string& name, const CacheBenchOptions& options, const Context& context) {
  std::optional<BenchView> loaded = load_bench_view(name, options.data, context);
  if (!loaded) {
    context.warn(fmt::format("{}: its files are not below the data folder (--data or SIGHTLINE_DATA); left out", name));
    return std::nullopt;
  }
  CacheView view;
  view.name = name;
  view.camera = loaded->camera;
  view.size_px = options.size_px.value_or(options.quick ? loaded->size_px / 8 : loaded->size_px);
  view.max_bounces = bounces_of(*loaded);
  view.world = World::build(std::move(loaded->scene), {}, context);
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
  const RenderResult result =
      render(view.world, view.camera, view.size_px, PixelFilter(PixelFilter::Kind::gaussian), render_request, context, Stopwatch());
  if (result.stop == StopReason::interrupted) context.check_cancelled();
  return {result.frame.color_image(), result.seconds.render, result.statistics};
}

std::vector<Shot> shoot_by_turns(const CacheView& view, const std::vector<ShotRequest>& requests, int rounds, const Context& context) {
  std::vector<Shot> shots;
  std::vector<std::vector<double>> seconds(requests.size());
  double first_round = 0;
  for (std::size_t i = 0; i < requests.size(); ++i) {
    shots.push_back(shoot(view, requests[i], context));
    seconds[i].push_back(shots.back().seconds);
    first_round += shots.back().seconds;
  }
  const int all = rounds > 0 ? rounds : first_round < kCheapRoundSeconds ? 3 : 1;
  for (int round = 1; round < all; ++round) {
    for (std::size_t i = 0; i < requests.size(); ++i) seconds[i].push_back(shoot(view, requests[i], context).seconds);
  }
  for (std::size_t i = 0; i < requests.size(); ++i) shots[i].seconds = median(seconds[i]);
  return shots;
}

std::vector<std::uint8_t> surface_mask(const CacheView& view, int spp, std::optional<SampleRange> range, const Context& context) {
  RenderRequest request;
  request.method = "visibility-cache";
  request.visibility = "exact";
  request.spp = spp, request.light_samples = 1, request.max_bounces = 0;
  request.sample_range = range;
  request.aovs.add(Aov::surface);
  const RenderResult result =
      render(view.world, view.camera, view.size_px, PixelFilter(PixelFilter::Kind::gaussian), request, context, Stopwatch());
  std::vector<std::uint8_t> mask(static_cast<std::size_t>(view.size_px.x) * static_cast<std::size_t>(view.size_px.y));
  for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = result.frame.value(Aov::surface, static_cast<std::uint32_t>(i)).x > 0.999f;
  return mask;
}

}  // namespace sightline
