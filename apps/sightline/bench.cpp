// sightline bench
#include "base/core/error.h"
#include "commands.h"

namespace sightline::app {

int run_bench(const CommandLine&, Console&, Context&) { throw usage_error("no benchmark suites yet"); }

}  // namespace sightline::app
