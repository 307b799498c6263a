// One function a command; each returns the process's exit code.
#pragma once

#include "base/core/context.h"
#include "command_line.h"
#include "console.h"

namespace sightline::app {

/// Exit codes (docs/cli.md).
enum ExitCode : int { kDone = 0, kBug = 1, kUsage = 2, kInput = 3, kResource = 4, kInterrupted = 5, kOverThreshold = 6 };

int run_render(const CommandLine& line, Console& console, Context& context);
int run_compare(const CommandLine& line, Console& console, Context& context);
int run_methods(const CommandLine& line);
int run_info(const CommandLine& line, Context& context);
int run_bake(const CommandLine& line, Console& console, Context& context);
int run_bench(const CommandLine& line, Console& console, Context& context);
int run_trace_bench(const CommandLine& line, Context& context);
int run_fragments_bench(const CommandLine& line, Context& context);
int run_visibility_cache_bench(const CommandLine& line, Context& context);
int run_square_lights_bench(const CommandLine& line, Context& context);
int run_gallery(const CommandLine& line);
int run_merge(const CommandLine& line, Context& context);

/// The store that --bake-dir names, else that of the user.
std::shared_ptr<BakeStore> open_bakes(const RenderCommand& command);

/// Writes text to a file, or to stdout for "-".
void write_text(const std::string& path, const std::string& text);

}  // namespace sightline::app
