// What the suites of `sightline bench` do alike with options and results.
#pragma once

#include <string>
#include <vector>

#include "bench/bench_results.h"
#include "commands.h"

namespace sightline::app {

/// "4,8" and repeated options alike.
std::vector<std::string> listed(const std::vector<std::string>& texts);

/// Throws if a file that is asked for could not be written, before the work starts.
void check_bench_outputs(const BenchCommand& command);
/// Writes what was asked for, and the tables to stdout unless something else went there. Returns the exit code.
int write_bench_results(const BenchCommand& command, const BenchResults& results, const std::string& markdown,
                        std::string (*html)(const BenchResults&), const Context& context);

}  // namespace sightline::app
