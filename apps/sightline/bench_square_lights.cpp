// sightline bench square-lights
#include "bench/square_lights/square_bench.h"
#include "bench_output.h"
#include "commands.h"

namespace sightline::app {

int run_square_lights_bench(const CommandLine& line, Context& context) {
  const BenchCommand& command = line.bench;
  SquareBenchOptions options;
  options.data = line.common.data_directory;
  options.bake_directory = command.bake_directory ? std::filesystem::path(*command.bake_directory) : default_bake_directory();
  options.views = command.views;
  options.parts = listed(command.parts);
  options.size_px = command.size_px;
  options.truth_samples = command.truth_samples.value_or(0);
  options.quick = command.quick;
  options.strip = !command.strip.empty();
  check_bench_outputs(command);

  const BenchResults results = run_square_bench(options, context);
  return write_bench_results(command, results, square_bench_markdown(results.json), square_bench_html, context);
}

}  // namespace sightline::app
