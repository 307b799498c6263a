// The suites of `sightline bench`, each declared once: its parts, and the options that not every suite reads.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "commands.h"

namespace sightline::app {

struct BenchSuite {
  const char* name;
  std::vector<std::string> (*parts)();  ///< null: it has none
  std::vector<std::string> options;     ///< those of optional_bench_options() that it reads
  int (*run)(const CommandLine& line, Context& context);
};

/// The first is the default.
const std::vector<BenchSuite>& bench_suites();

/// An option that belongs to some suites: whether the command line has it.
struct BenchOption {
  const char* name;
  bool (*given)(const BenchCommand& command);
};
const std::vector<BenchOption>& optional_bench_options();
/// Names of the suites that read it.
std::vector<std::string> suites_with(std::string_view option);

}  // namespace sightline::app
