// sightline bench
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
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

/// An option that not every suite reads.
struct SuiteOption {
  const char* name;
  bool given;
  std::vector<std::string> suites;
};

void check_suite_options(const BenchCommand& command, const std::string& suite) {
  const std::vector<SuiteOption> options = {
      {"--part", !command.parts.empty(), {"fragments", "visibility-cache"}},
      {"--html", !command.html.empty(), {"fragments", "visibility-cache"}},
      {"--strip", !command.strip.empty(), {"fragments", "visibility-cache"}},
      {"--ce", !command.ce.empty(), {"visibility-cache"}},
      {"--spp", !command.spp.empty(), {"visibility-cache"}},
      {"--truth-samples", command.truth_samples.has_value(), {"fragments"}},
      {"--rounds", command.rounds.has_value(), {"fragments"}},
      {"--cache-dir", !command.cache_directory.empty(), {"fragments"}},
  };
  for (const SuiteOption& option : options) {
    if (option.given && std::find(option.suites.begin(), option.suites.end(), suite) == option.suites.end())
      throw usage_error(
          fmt::format("{} belongs to the suite{} {}", option.name, option.suites.size() > 1 ? "s" : "", fmt::join(option.suites, " and ")));
  }
}

}  // namespace

int run_bench(const CommandLine& line, Console&, Context& context) {
  constexpr const char* kKnown = "known: trace, fragments, visibility-cache";
  const BenchCommand& command = line.bench;
  if (command.suites.size() > 1) throw usage_error("one benchmark suite at a time").remedy(kKnown);
  const std::string suite = command.suites.empty() ? "trace" : command.suites.front();
  context.progress = {};
  if (suite != "trace" && suite != "fragments" && suite != "visibility-cache")
    throw usage_error("unknown benchmark suite '" + suite + "'").remedy(kKnown);
  check_suite_options(command, suite);
  if (suite == "visibility-cache") return run_visibility_cache_bench(line, context);
  if (suite == "fragments") return run_fragments_bench(line, context);
  return run_trace(line, context);
}

}  // namespace sightline::app
