#include "bench/square_lights/square_bench.h"

#include "base/core/error.h"
#include "bench/bench_plan.h"
#include "bench/square_lights/aims.h"
#include "bench/square_lights/figures.h"
#include "bench/square_lights/parts.h"
#include "sightline/version.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

std::vector<BenchPart> make_parts() {
  const std::vector<std::string> armadillo = {"armadillo-sky", "armadillo-sky-sun", "armadillo-sky-window", "armadillo-sky-grace"};
  const std::vector<std::string> teapot = {"teapot-sky", "teapot-sky-sun", "teapot-sky-window", "teapot-sky-grace"};
  std::vector<std::string> both = armadillo, baked = armadillo;
  both.insert(both.end(), teapot.begin(), teapot.end());
  baked.emplace_back("pair-sky");
  return {
      {"errors", both},
      {"bakes", baked},
      {"speed", {"armadillo-sky", "movers-5-sky", "movers-12-sky"}},
      {"edit", {"armadillo-sky"}},
      {"storage", {"armadillo-sky", "pair-sky"}},
      {"rotation", {"duck-sky"}},
      {"moving", {"pair-sky", "pair-sky-sun"}},
      {"beyond", {"armadillo-sky", "pair-sky"}},
      {"pictures", figure_views()},
  };
}

const std::vector<BenchPart>& part_table() {
  static const std::vector<BenchPart> table = make_parts();
  return table;
}

void measure_view(const SquareStage& stage, const BenchPlan& plan, const SquareBenchShared& shared, BenchResults& results,
                  const Context& context) {
  const auto add = [&](const char* part, const auto& measure) {
    if (!plan.has(part, stage.name)) return;
    if (Json measured = measure(); !measured.is_null()) results.json[part].push_back(std::move(measured));
  };
  // Bakes come first: their store is empty, whatever the others have made.
  add("bakes", [&] { return square_bakes(stage, shared, context); });
  add("speed", [&] { return square_speed(stage, shared, context); });
  add("edit", [&] { return square_edit(stage, shared, context); });
  add("errors", [&] { return square_errors(stage, shared, context); });
  add("storage", [&] { return square_storage(stage, shared, results.pictures, context); });
  add("rotation", [&] { return square_rotation(stage, shared, context); });
  add("moving", [&] { return square_moving(stage, shared, results.strip, context); });
  add("beyond", [&] { return square_beyond(stage, shared, context); });
  if (plan.has("pictures", stage.name)) square_pictures(stage, shared, results.pictures, context);
}

}  // namespace

std::vector<std::string> square_bench_parts() { return part_names(part_table()); }

BenchResults run_square_bench(const SquareBenchOptions& options, const Context& context) {
  const BenchPlan plan(part_table(), options.parts, options.views);
  plan.check_read("--strip", options.strip, {"moving"});
  plan.check_read("--truth-samples", options.truth_samples > 0, {"moving", "pictures"});
  BenchResults results;
  results.json = {{"sightline", kVersion},      {"suite", "square-lights"}, {"threads", context.thread_count()},
                  {"simd", simd_target_name()}, {"quick", options.quick},   {"interrupted", false}};
  for (const std::string& part : square_bench_parts()) {
    if (part != "pictures") results.json[part] = Json::array();
  }
  const SquareBenchShared shared{options, std::make_shared<BakeStore>(options.bake_directory)};
  try {
    for (const std::string& name : plan.views()) {
      context.check_cancelled();
      if (const std::optional<SquareStage> stage = load_stage(name, options, context)) measure_view(*stage, plan, shared, results, context);
    }
  } catch (const Error& error) {
    // What hours have measured is not thrown away.
    if (error.code() != ErrorCode::interrupted) throw;
    results.json["interrupted"] = true;
  }
  results.json["aims"] = square_bench_aims(results.json);
  return results;
}

}  // namespace sightline
