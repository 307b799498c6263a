// sightline bench
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/core/error.h"
#include "bench_suites.h"
#include "commands.h"

namespace sightline::app {
namespace {

std::string known_suites() {
  std::vector<std::string> names;
  for (const BenchSuite& suite : bench_suites()) names.emplace_back(suite.name);
  return fmt::format("known: {}", fmt::join(names, ", "));
}

const BenchSuite& find_suite(const std::string& name) {
  for (const BenchSuite& suite : bench_suites()) {
    if (suite.name == name) return suite;
  }
  throw usage_error("unknown benchmark suite '" + name + "'").remedy(known_suites());
}

// An option that the suite does not read is a mistake.
void check_options(const BenchCommand& command, const BenchSuite& suite) {
  for (const BenchOption& option : optional_bench_options()) {
    if (!option.given(command) || std::find(suite.options.begin(), suite.options.end(), option.name) != suite.options.end()) continue;
    const std::vector<std::string> readers = suites_with(option.name);
    throw usage_error(fmt::format("{} belongs to the suite{} {}", option.name, readers.size() > 1 ? "s" : "", fmt::join(readers, " and ")));
  }
}

}  // namespace

int run_bench(const CommandLine& line, Console&, Context& context) {
  const BenchCommand& command = line.bench;
  if (command.suites.size() > 1) throw usage_error("one benchmark suite at a time").remedy(known_suites());
  context.progress = {};
  const BenchSuite& suite = command.suites.empty() ? bench_suites().front() : find_suite(command.suites.front());
  check_options(command, suite);
  return suite.run(line, context);
}

}  // namespace sightline::app
