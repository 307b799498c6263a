// Ray reduction, speed-up and errors against C_E [Popov2013, Figs. 5-7].
#include <fmt/format.h>

#include "bench/thumbnail.h"
#include "bench/visibility_cache/figures.h"
#include "bench/visibility_cache/parts.h"
#include "image/metrics/metrics.h"

namespace sightline {
namespace {

// Pictures of the page: enough to see shadows by, and some hundred kilobytes each.
constexpr int kPageWidth = 800;

}  // namespace

using Json = nlohmann::ordered_json;

Json cache_errors(const ColorImage& reference, const ColorImage& image, std::span<const std::uint8_t> mask) {
  MetricOptions options;
  options.mask = mask;
  Json json = Json::object();
  for (const char* name : {"linf", "l2", "flip"}) json[name] = find_metric(name).compute(reference, image, options);
  json["signed_error"] = signed_error(reference, image, mask);
  return json;
}

Json cache_rays(const Shot& shot, const Shot& exact) {
  const QueryFigures figures = query_figures(shot.statistics.visibility);
  const auto all = static_cast<double>(exact.statistics.rays.occlusion);
  return {{"seconds", shot.seconds},
          {"speed_up", shot.seconds > 0 ? exact.seconds / shot.seconds : 0},
          {"queries", shot.statistics.visibility.queries},
          {"traced", shot.statistics.visibility.traced},
          {"share_traced", figures.share_traced},
          {"ray_reduction", figures.ray_reduction},
          // Of all occlusion rays, those that choose virtual point lights included.
          {"occlusion_rays_kept", all > 0 ? static_cast<double>(shot.statistics.rays.occlusion) / all : 0},
          {"lookups_per_query", figures.lookups_per_query},
          {"rejected_share", figures.rejected_share}};
}

Json cache_curves(const CacheView& view, const CacheBenchOptions& options, std::vector<BenchPicture>& pictures, const Context& context) {
  const std::vector<double> edges = !options.ce.empty() ? options.ce : std::vector<double>{4, 8, 16, 36, 64};
  const std::vector<int> samples = !options.spp.empty() ? options.spp : options.quick ? std::vector{1, 4} : std::vector{1, 9, 16};
  Json json = {{"view", view.name},
               {"size", {view.size_px.x, view.size_px.y}},
               {"triangles", instanced_triangle_count(view.world->scene())},
               {"light_samples", view.light_samples},
               {"max_bounces", view.max_bounces},
               {"settings", options.settings},
               {"samples", Json::array()}};
  for (const int spp : samples) {
    context.info(fmt::format("bench visibility-cache: curves, {}, {} samples a pixel", view.name, spp));
    std::vector<ShotRequest> requests = {{.visibility = "exact", .spp = spp}};
    for (const double ce : edges) {
      requests.push_back({.settings = {fmt::format("ce={}", ce)}, .spp = spp});
      requests.back().settings.insert(requests.back().settings.end(), options.settings.begin(), options.settings.end());
    }
    const std::vector<Shot> shots = shoot_by_turns(view, requests, options.quick ? 1 : 0, context);
    const Shot& exact = shots.front();
    const std::vector<std::uint8_t> mask = surface_mask(view, spp, {}, context);
    const auto rays = static_cast<double>(exact.statistics.rays.closest + exact.statistics.rays.occlusion);
    Json rows = Json::array();
    for (std::size_t i = 1; i < shots.size(); ++i) {
      Json row = {{"ce", edges[i - 1]}};
      row.update(cache_rays(shots[i], exact));
      row.update(cache_errors(exact.image, shots[i].image, mask));
      rows.push_back(std::move(row));
    }
    json["samples"].push_back({{"spp", spp},
                               {"exact",
                                {{"seconds", exact.seconds},
                                 {"queries", exact.statistics.visibility.queries},
                                 {"mray_per_s", exact.seconds > 0 ? rays * 1e-6 / exact.seconds : 0}}},
                               {"cached", std::move(rows)}});
    if (spp != samples.back()) continue;
    // The middle of the range beside the truth.
    const std::size_t shown = (edges.size() + 1) / 2;
    pictures.push_back(
        {view.name + ", exact", fmt::format("{} samples a pixel", spp), thumbnail(exact.image, kPageWidth), viewing_exposure(exact.image)});
    pictures.push_back({view.name + ", cached",
                        fmt::format("{} samples a pixel, C_E = {}", spp, edges[shown - 1]),
                        thumbnail(shots[shown].image, kPageWidth),
                        {}});
  }
  return json;
}

}  // namespace sightline
