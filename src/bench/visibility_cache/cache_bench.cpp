#include "bench/visibility_cache/cache_bench.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/core/error.h"
#include "base/settings/settings.h"
#include "bench/bench_views.h"
#include "bench/visibility_cache/aims.h"
#include "bench/visibility_cache/cache_view.h"
#include "bench/visibility_cache/parts.h"
#include "sightline/version.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

/// A part with the views it takes by itself.
struct Part {
  std::string name;
  std::vector<std::string> views;
};

const std::vector<Part>& part_table() {
  static const std::vector<Part> table = {
      {"curves", {"sponza-points", "sponza-court", "conference-9", "kitchen-vpl", "hairball-open"}},
      {"rivals", {"sponza-points", "sponza-court", "conference-9"}},
      {"lookup", {"sponza-points", "sponza-court", "kitchen-vpl"}},
      {"flicker", {"sponza-points"}},
      {"ablations", {"sponza-points", "sponza-court"}},
  };
  return table;
}

bool contains(const std::vector<std::string>& list, const std::string& name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

/// What is to be done, views outermost: each is loaded and built once.
class Plan {
 public:
  explicit Plan(const CacheBenchOptions& options) : options_(options) {
    const std::vector<std::string> known = cache_bench_parts();
    for (const std::string& part : options.parts) {
      if (contains(known, part)) continue;
      const std::string nearest = nearest_name(part, known);
      throw usage_error("unknown part '" + part + "'")
          .remedy(nearest.empty() ? "known: curves, rivals, lookup, flicker, ablations" : "did you mean '" + nearest + "'?");
    }
    // An option that none of the parts reads is a mistake.
    check_read("--ce", !options.ce.empty(), {"curves"});
    check_read("--spp", !options.spp.empty(), {"curves", "rivals"});
    check_read("--strip", options.strip, {"flicker"});
    // Before hours of work, not after.
    for (const std::string& view : options.views) check_bench_view(view);
    for (const Part& part : part_table()) {
      if (!wanted(part)) continue;
      for (const std::string& view : options.views.empty() ? part.views : options.views) {
        if (!contains(views_, view)) views_.push_back(view);
      }
    }
  }
  const std::vector<std::string>& views() const { return views_; }
  bool has(const std::string& part_name, const std::string& view) const {
    const auto part = std::find_if(part_table().begin(), part_table().end(), [&](const Part& p) { return p.name == part_name; });
    return wanted(*part) && (!options_.views.empty() || contains(part->views, view));
  }

 private:
  void check_read(const char* option, bool given, const std::vector<std::string>& readers) const {
    if (!given ||
        std::any_of(part_table().begin(), part_table().end(), [&](const Part& p) { return wanted(p) && contains(readers, p.name); }))
      return;
    throw usage_error(fmt::format("{} has no effect on the parts asked for", option))
        .remedy(fmt::format("leave it out or add --part {}", fmt::join(readers, " or ")));
  }
  bool wanted(const Part& part) const { return options_.parts.empty() || contains(options_.parts, part.name); }
  const CacheBenchOptions& options_;
  std::vector<std::string> views_;
};

void measure_view(const CacheView& view, const Plan& plan, const CacheBenchOptions& options, CacheBenchResults& results,
                  const Context& context) {
  Json& json = results.json;
  if (plan.has("curves", view.name)) json["curves"].push_back(cache_curves(view, options, results.pictures, context));
  if (plan.has("rivals", view.name)) {
    json["equal_time"].push_back(cache_equal_time(view, options, context));
    if (view.has_punctual) json["shadow_maps"].push_back(cache_shadow_maps(view, options, context));
  }
  if (plan.has("lookup", view.name)) json["lookup"].push_back(cache_lookup(view, options, context));
  if (plan.has("flicker", view.name)) json["flicker"].push_back(cache_flicker(view, options, results.strip, context));
  if (plan.has("ablations", view.name)) json["ablations"].push_back(cache_ablations(view, options, context));
}

}  // namespace

std::vector<std::string> cache_bench_parts() {
  std::vector<std::string> names;
  for (const Part& part : part_table()) names.push_back(part.name);
  return names;
}

CacheBenchResults run_cache_bench(const CacheBenchOptions& options, const Context& context) {
  const Plan plan(options);
  CacheBenchResults results;
  results.json = {{"sightline", kVersion},      {"suite", "visibility-cache"}, {"threads", context.thread_count()},
                  {"simd", simd_target_name()}, {"quick", options.quick},      {"interrupted", false}};
  for (const char* part : {"curves", "equal_time", "shadow_maps", "lookup", "flicker", "ablations"}) results.json[part] = Json::array();
  try {
    for (const std::string& name : plan.views()) {
      context.check_cancelled();
      if (const std::optional<CacheView> view = load_cache_view(name, options, context))
        measure_view(*view, plan, options, results, context);
    }
  } catch (const Error& error) {
    // What hours have measured is not thrown away.
    if (error.code() != ErrorCode::interrupted) throw;
    results.json["interrupted"] = true;
  }
  results.json["aims"] = cache_bench_aims(results.json);
  return results;
}

}  // namespace sightline
