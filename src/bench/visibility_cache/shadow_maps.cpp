// Plain shadow maps beside the cache [Popov2013, Fig. 8]. The time of filling the maps stands apart.
#include <fmt/format.h>

#include "bench/visibility_cache/figures.h"
#include "bench/visibility_cache/parts.h"

namespace sightline {

using Json = nlohmann::ordered_json;

Json cache_shadow_maps(const CacheView& view, const CacheBenchOptions& options, const Context& context) {
  constexpr double kEdge = 14;
  const std::vector<int> sizes = options.quick ? std::vector{128, 512} : std::vector{1024, 2048, 6000};
  const std::vector<int> samples = !options.spp.empty() ? options.spp : options.quick ? std::vector{1} : std::vector{1, 16};
  Json json = {{"view", view.name}, {"size", {view.size_px.x, view.size_px.y}}, {"ce", kEdge}, {"samples", Json::array()}};
  for (const int spp : samples) {
    context.info(fmt::format("bench visibility-cache: shadow maps, {}, {} samples a pixel", view.name, spp));
    const std::vector<Shot> shots = shoot_by_turns(view,
                                                   {{.visibility = "exact", .spp = spp},
                                                    {.settings = {fmt::format("ce={}", kEdge)}, .spp = spp},
                                                    {.settings = {fmt::format("ce={}", kEdge), "counters=3"}, .spp = spp}},
                                                   options.quick ? 1 : 0, context);
    const Shot &exact = shots[0], &cached = shots[1], &careful = shots[2];
    const std::vector<std::uint8_t> mask = surface_mask(view, spp, {}, context);
    const auto row_of = [&](const std::string& name, const Shot& shot) {
      const VisibilityCounts& counts = shot.statistics.visibility;
      Json row = {{"name", name},
                  {"seconds", shot.seconds},
                  {"filling_core_seconds", counts.filling_seconds},
                  // Threads fill side by side.
                  {"seconds_without_filling", shot.seconds - counts.filling_seconds / context.thread_count()},
                  {"rays", shot.statistics.rays.closest + shot.statistics.rays.occlusion},
                  {"filling_rays", counts.filling}};
      row.update(cache_errors(exact.image, shot.image, mask));
      return row;
    };
    Json rows = {row_of("exact", exact), row_of(fmt::format("cached, C_E = {}", kEdge), cached),
                 row_of(fmt::format("cached, C_E = {}, counters=3", kEdge), careful)};
    for (const int size : sizes) {
      const ShotRequest request{.visibility = "shadow-map", .settings = {fmt::format("resolution={}", size)}, .spp = spp};
      rows.push_back(row_of(fmt::format("shadow maps, {0}x{0}", size), shoot(view, request, context)));
    }
    json["samples"].push_back({{"spp", spp}, {"rows", std::move(rows)}});
  }
  return json;
}

}  // namespace sightline
