// sightline bench
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/core/error.h"
#include "bench/trace_bench.h"
#include "commands.h"

namespace sightline::app {
namespace {

int run_trace(const CommandLine& line, const Context& context) {
  const BenchCommand& command = line.bench;
  TraceBenchOptions options;
  options.data = line.common.data_directory;
  options.quick = command.quick;
  options.size_px = command.size_px;
  if (!command.views.empty()) options.views = command.views;
  const nlohmann::ordered_json results = run_trace_bench(options, context);
  const std::string markdown = trace_bench_markdown(results);
  if (!command.json.empty()) write_text(command.json, results.dump(2) + "\n");
  if (!command.markdown.empty()) write_text(command.markdown, markdown);
  if (command.json != "-" && command.markdown != "-") fmt::print("{}", markdown);
  return kDone;
}

}  // namespace

int run_bench(const CommandLine& line, Console&, Context& context) {
  const BenchCommand& command = line.bench;
  if (command.suites.size() > 1) throw usage_error("one benchmark suite at a time").remedy("known: trace, visibility-cache");
  const std::string suite = command.suites.empty() ? "trace" : command.suites.front();
  context.progress = {};
  if (suite == "visibility-cache") return run_visibility_cache_bench(line, context);
  if (suite != "trace") throw usage_error("unknown benchmark suite '" + suite + "'").remedy("known: trace, visibility-cache");
  if (!command.html.empty() || !command.strip.empty() || !command.parts.empty() || !command.ce.empty() || !command.spp.empty())
    throw usage_error("--html, --strip, --part, --ce and --spp belong to the suite visibility-cache");
  return run_trace(line, context);
}

}  // namespace sightline::app
