#include "bench_suites.h"

#include <algorithm>

#include "bench/fragments/fragment_bench.h"
#include "bench/square_lights/square_bench.h"
#include "bench/trace_bench.h"
#include "bench/visibility_cache/cache_bench.h"

namespace sightline::app {

const std::vector<BenchSuite>& bench_suites() {
  static const std::vector<BenchSuite> table = {
      {"trace", trace_bench_parts, {"--part", "--rounds"}, run_trace_bench},
      {"fragments",
       fragment_bench_parts,
       {"--part", "--html", "--strip", "--truth-samples", "--rounds", "--cache-dir"},
       run_fragments_bench},
      {"visibility-cache", cache_bench_parts, {"--part", "--html", "--strip", "--ce", "--spp", "--set"}, run_visibility_cache_bench},
      {"square-lights", square_bench_parts, {"--part", "--html", "--strip", "--truth-samples", "--bake-dir"}, run_square_lights_bench},
  };
  return table;
}

const std::vector<BenchOption>& optional_bench_options() {
  static const std::vector<BenchOption> table = {
      {"--part", [](const BenchCommand& c) { return !c.parts.empty(); }},
      {"--html", [](const BenchCommand& c) { return !c.html.empty(); }},
      {"--strip", [](const BenchCommand& c) { return !c.strip.empty(); }},
      {"--ce", [](const BenchCommand& c) { return !c.ce.empty(); }},
      {"--set", [](const BenchCommand& c) { return !c.settings.empty(); }},
      {"--spp", [](const BenchCommand& c) { return !c.spp.empty(); }},
      {"--truth-samples", [](const BenchCommand& c) { return c.truth_samples.has_value(); }},
      {"--rounds", [](const BenchCommand& c) { return c.rounds.has_value(); }},
      {"--cache-dir", [](const BenchCommand& c) { return !c.cache_directory.empty(); }},
      {"--bake-dir", [](const BenchCommand& c) { return c.bake_directory.has_value(); }},
  };
  return table;
}

std::vector<std::string> suites_with(std::string_view option) {
  std::vector<std::string> names;
  for (const BenchSuite& suite : bench_suites()) {
    if (std::find(suite.options.begin(), suite.options.end(), option) != suite.options.end()) names.emplace_back(suite.name);
  }
  return names;
}

}  // namespace sightline::app
