// The same time for everyone: what error is left against a reference with many samples?
//
// Cached answers set the time. Exact rays and NEE++ get as many samples a pixel, or as many light samples, as fit into it.
#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "bench/visibility_cache/figures.h"
#include "bench/visibility_cache/parts.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

// More samples than so many times those of the cached picture are not given to anyone.
constexpr int kMostTimes = 4;

/// A way to render, with a number of samples to be fitted to a time.
struct Rival {
  std::string name;
  ShotRequest request;
  bool fewer_light_samples = false;  ///< else fewer samples a pixel
};

struct Fitted {
  Shot shot;
  int spp = 0, light_samples = 0;
};

// Time is not quite proportional to samples: the second guess starts from the first's time.
Fitted fit(const CacheView& view, const Rival& rival, int spp, double budget_s, const Context& context) {
  int samples = rival.fewer_light_samples ? view.light_samples : spp;
  const int most = rival.fewer_light_samples ? view.light_samples : kMostTimes * spp;
  Fitted fitted;
  for (int round = 0; round < 3; ++round) {
    ShotRequest request = rival.request;
    request.direct_only = true;
    request.spp = rival.fewer_light_samples ? spp : samples;
    request.light_samples = rival.fewer_light_samples ? samples : view.light_samples;
    fitted = {shoot(view, request, context), request.spp, request.light_samples};
    const int better = std::min(most, samples_in_time(samples, fitted.shot.seconds, budget_s));
    if (better == samples) break;
    if (round < 2) samples = better;
  }
  return fitted;
}

}  // namespace

Json cache_equal_time(const CacheView& view, const CacheBenchOptions& options, const Context& context) {
  const int spp = options.quick ? 4 : 16, reference_spp = options.quick ? 16 : 128;
  const double ce = options.quick ? 8 : 16;
  context.info(fmt::format("bench visibility-cache: equal time, {}", view.name));
  ShotRequest cached{.settings = {fmt::format("ce={}", ce)}, .spp = spp, .direct_only = true};
  const Shot ours = shoot_by_turns(view, {cached}, options.quick ? 1 : 0, context).front();

  std::vector<Rival> rivals = {{"exact, fewer samples a pixel", {.visibility = "exact"}, false},
                               // What a pass learns is used from the next one on.
                               {"nee++, fewer samples a pixel", {.visibility = "nee++", .settings = {"pass_spp=1"}}, false}};
  if (view.has_sampled) {
    rivals.push_back({"exact, fewer light samples", {.visibility = "exact"}, true});
    rivals.push_back({"nee++, fewer light samples", {.visibility = "nee++", .settings = {"pass_spp=1"}}, true});
  }
  std::vector<Fitted> fitted;
  fitted.reserve(rivals.size());
  for (const Rival& rival : rivals) fitted.push_back(fit(view, rival, spp, ours.seconds, context));

  // Other samples than those compared, which may be up to kMostTimes as many.
  const auto first = static_cast<std::uint32_t>((kMostTimes * spp + 15) / 16 * 16);
  const int total = static_cast<int>(first) + reference_spp;
  const SampleRange others{first, static_cast<std::uint32_t>(total)};
  const Shot reference = shoot(view, {.visibility = "exact", .spp = total, .range = others, .direct_only = true}, context);
  // What any of the pictures saw of a light or of the background does not count.
  std::vector<std::uint8_t> mask = surface_mask(view, total, others, context);
  int most_spp = spp;
  for (const Fitted& one : fitted) most_spp = std::max(most_spp, one.spp);
  for (const int used : {spp, most_spp}) {
    const std::vector<std::uint8_t> own = surface_mask(view, used, {}, context);
    for (std::size_t i = 0; i < mask.size(); ++i) mask[i] &= own[i];
  }
  Json rows = Json::array();
  const auto add = [&](const std::string& name, const Shot& shot, int used_spp, int light_samples) {
    Json row = {{"name", name}, {"spp", used_spp}, {"light_samples", light_samples}, {"seconds", shot.seconds}};
    row["share_traced"] = query_figures(shot.statistics.visibility).share_traced;
    row.update(cache_errors(reference.image, shot.image, mask));
    rows.push_back(std::move(row));
  };
  add(fmt::format("cached, C_E = {}", ce), ours, spp, view.light_samples);
  for (std::size_t i = 0; i < rivals.size(); ++i) add(rivals[i].name, fitted[i].shot, fitted[i].spp, fitted[i].light_samples);
  return {{"view", view.name},
          {"size", {view.size_px.x, view.size_px.y}},
          {"ce", ce},
          {"reference_spp", reference_spp},
          {"rows", std::move(rows)}};
}

}  // namespace sightline
