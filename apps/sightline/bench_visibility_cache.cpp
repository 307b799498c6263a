// sightline bench visibility-cache
#include "base/settings/settings.h"
#include "bench/visibility_cache/cache_bench.h"
#include "bench_output.h"
#include "commands.h"

namespace sightline::app {
int run_visibility_cache_bench(const CommandLine& line, Context& context) {
  const BenchCommand& command = line.bench;
  CacheBenchOptions options;
  options.data = line.common.data_directory;
  options.views = command.views;
  options.parts = listed(command.parts);
  for (const std::string& text : listed(command.ce)) options.ce.push_back(parse_real("--ce", text, {.minimum = 1e-3, .maximum = 1e6}));
  for (const std::string& text : listed(command.spp))
    options.spp.push_back(static_cast<int>(parse_integer("--spp", text, {.minimum = 1, .maximum = 65536})));
  options.settings = command.settings;
  options.size_px = command.size_px;
  options.quick = command.quick;
  options.strip = !command.strip.empty();
  check_bench_outputs(command);

  const BenchResults results = run_cache_bench(options, context);
  return write_bench_results(command, results, cache_bench_markdown(results.json), cache_bench_html, context);
}

}  // namespace sightline::app
