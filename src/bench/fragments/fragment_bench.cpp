#include "bench/fragments/fragment_bench.h"

#include <fmt/format.h>

#include "base/core/error.h"
#include "bench/bench_plan.h"
#include "bench/fragments/aims.h"
#include "bench/fragments/parts.h"
#include "sightline/version.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

const std::vector<BenchPart>& part_table() {
  static const std::vector<BenchPart> table = {
      {"table", {"sponza-court", "conference", "hairball-room"}},
      {"curve", {"sponza-court", "conference", "hairball-room"}},
      {"sizes", {"sponza-court"}},
      {"interactive", {"sponza-court"}},
      {"temporal", {"sponza-court"}},
  };
  return table;
}

/// False, with a warning, for a view with lights or materials that the method does not know: the others are worth measuring.
bool supported(const BuiltView& view, const Context& context) {
  try {
    check_supported(find_method("fragments"), view.world->scene());
    return true;
  } catch (const Error& error) {
    context.warn(fmt::format("{}: left out: {}", view.name, error.what()));
    return false;
  }
}

void measure_view(const BuiltView& view, const BenchPlan& plan, const FragmentBenchOptions& options, BenchResults& results,
                  const Context& context) {
  Json& json = results.json;
  if (plan.has("table", view.name)) json["table"].push_back(fragment_table(view, options, results.pictures, context));
  if (plan.has("curve", view.name)) json["curve"].push_back(fragment_curve(view, options, context));
  if (plan.has("sizes", view.name)) {
    if (Json sizes = fragment_sizes(view, options, context); !sizes.is_null()) json["sizes"].push_back(std::move(sizes));
  }
  if (plan.has("interactive", view.name)) json["interactive"].push_back(fragment_interactive(view, options, results.strip, context));
  if (plan.has("temporal", view.name)) json["temporal"].push_back(fragment_temporal(view, options, context));
}

}  // namespace

std::vector<std::string> fragment_bench_parts() { return part_names(part_table()); }

BenchResults run_fragment_bench(const FragmentBenchOptions& options, const Context& context) {
  const BenchPlan plan(part_table(), options.parts, options.views);
  plan.check_read("--strip", options.strip, {"interactive"});
  plan.check_read("--truth-samples", options.truth_samples > 0, {"table", "curve", "sizes", "temporal"});
  plan.check_read("--cache-dir", !options.cache.empty(), {"table", "curve", "sizes", "temporal"});
  plan.check_read("--rounds", options.rounds > 0, {"table", "curve", "sizes"});
  BenchResults results;
  results.json = {{"sightline", kVersion},      {"suite", "fragments"},   {"threads", context.thread_count()},
                  {"simd", simd_target_name()}, {"quick", options.quick}, {"interrupted", false}};
  for (const std::string& part : fragment_bench_parts()) results.json[part] = Json::array();
  try {
    for (const std::string& name : plan.views()) {
      context.check_cancelled();
      const std::optional<BuiltView> view = load_built_view(name, options.data, options.size_px, options.quick, context);
      if (view && supported(*view, context)) measure_view(*view, plan, options, results, context);
    }
  } catch (const Error& error) {
    // What hours have measured is not thrown away.
    if (error.code() != ErrorCode::interrupted) throw;
    results.json["interrupted"] = true;
  }
  results.json["aims"] = fragment_bench_aims(results.json);
  return results;
}

}  // namespace sightline
