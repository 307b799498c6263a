// sightline bench trace
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "bench/trace_bench.h"
#include "commands.h"

namespace sightline::app {

int run_trace_bench(const CommandLine& line, Context& context) {
  const BenchCommand& command = line.bench;
  TraceBenchOptions options;
  options.data = line.common.data_directory;
  options.quick = command.quick;
  options.size_px = command.size_px;
  if (!command.views.empty()) options.views = command.views;
  const nlohmann::ordered_json results = sightline::run_trace_bench(options, context);
  const std::string markdown = trace_bench_markdown(results);
  if (!command.json.empty()) write_text(command.json, results.dump(2) + "\n");
  if (!command.markdown.empty()) write_text(command.markdown, markdown);
  if (command.json != "-" && command.markdown != "-") fmt::print("{}", markdown);
  return kDone;
}

}  // namespace sightline::app
