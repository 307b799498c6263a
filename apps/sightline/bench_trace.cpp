// sightline bench trace
#include "bench/trace_bench.h"
#include "bench_output.h"
#include "commands.h"

namespace sightline::app {

int run_trace_bench(const CommandLine& line, Context& context) {
  const BenchCommand& command = line.bench;
  TraceBenchOptions options;
  options.data = line.common.data_directory;
  options.views = command.views;
  options.parts = listed(command.parts);
  options.size_px = command.size_px;
  options.rounds = command.rounds.value_or(0);
  options.quick = command.quick;
  check_bench_outputs(command);

  const BenchResults results = sightline::run_trace_bench(options, context);
  return write_bench_results(command, results, trace_bench_markdown(results.json), nullptr, context);
}

}  // namespace sightline::app
