#include "bench/visibility_cache/cache_bench.h"

#include "base/core/error.h"
#include "bench/bench_plan.h"
#include "bench/visibility_cache/aims.h"
#include "bench/visibility_cache/cache_view.h"
#include "bench/visibility_cache/parts.h"
#include "sightline/version.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

const std::vector<BenchPart>& part_table() {
  static const std::vector<BenchPart> table = {
      {"curves", {"sponza-points", "sponza-court", "conference-9", "kitchen-vpl", "hairball-open"}},
      {"rivals", {"sponza-points", "sponza-court", "conference-9"}},
      {"lookup", {"sponza-points", "sponza-court", "kitchen-vpl"}},
      {"flicker", {"sponza-points"}},
      {"ablations", {"sponza-points", "sponza-court"}},
  };
  return table;
}

void measure_view(const CacheView& view, const BenchPlan& plan, const CacheBenchOptions& options, BenchResults& results,
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

std::vector<std::string> cache_bench_parts() { return part_names(part_table()); }

BenchResults run_cache_bench(const CacheBenchOptions& options, const Context& context) {
  const BenchPlan plan(part_table(), options.parts, options.views);
  plan.check_read("--ce", !options.ce.empty(), {"curves"});
  plan.check_read("--spp", !options.spp.empty(), {"curves", "rivals"});
  plan.check_read("--set", !options.settings.empty(), {"curves"});
  plan.check_read("--strip", options.strip, {"flicker"});
  BenchResults results;
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
