// sightline bench fragments
#include "bench/fragments/fragment_bench.h"
#include "bench_output.h"
#include "commands.h"

namespace sightline::app {

int run_fragments_bench(const CommandLine& line, Context& context) {
  const BenchCommand& command = line.bench;
  FragmentBenchOptions options;
  options.data = line.common.data_directory;
  options.cache = command.cache_directory;
  options.views = command.views;
  options.parts = listed(command.parts);
  options.size_px = command.size_px;
  options.truth_samples = command.truth_samples.value_or(0);
  options.rounds = command.rounds.value_or(0);
  options.quick = command.quick;
  options.strip = !command.strip.empty();
  check_bench_outputs(command);

  const BenchResults results = run_fragment_bench(options, context);
  return write_bench_results(command, results, fragment_bench_markdown(results.json), fragment_bench_html, context);
}

}  // namespace sightline::app
