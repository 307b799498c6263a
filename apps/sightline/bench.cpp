// sightline bench
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/core/error.h"
#include "bench/bench_views.h"
#include "bench/trace_bench.h"
#include "commands.h"

namespace sightline::app {

int run_bench(const CommandLine& line, Console&, Context& context) {
  const BenchCommand& command = line.bench;
  TraceBenchOptions options;
  options.data = line.common.data_directory;
  options.quick = command.quick;
  options.size_px = command.size_px;
  if (!command.views.empty()) options.views = command.views;
  for (const std::string& suite : command.suites) {
    if (suite != "trace") throw usage_error("unknown benchmark suite '" + suite + "'").remedy("known: trace");
  }
  context.progress = {};
  const nlohmann::ordered_json results = run_trace_bench(options, context);
  const std::string markdown = trace_bench_markdown(results);
  if (!command.json.empty()) write_text(command.json, results.dump(2) + "\n");
  if (!command.markdown.empty()) write_text(command.markdown, markdown);
  if (command.json != "-" && command.markdown != "-") fmt::print("{}", markdown);
  return kDone;
}

}  // namespace sightline::app
