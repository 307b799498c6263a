// The program: parses the command line, runs one command, turns failures into one line and an exit code.
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <system_error>

#include "base/core/error.h"
#include "base/simd/simd_target.h"
#include "commands.h"

namespace {

// A signal handler can only reach globals; this one points at the flag of the command that runs.
std::atomic<std::atomic<bool>*> cancelled_flag{nullptr};

extern "C" void on_signal(int) {
  // A second Ctrl-C leaves at once.
  if (std::atomic<bool>* flag = cancelled_flag.load(); flag && !flag->exchange(true)) return;
  _exit(sightline::app::kInterrupted);
}

/// While it lives, the first Ctrl-C sets the context's flag.
class SignalScope {
 public:
  explicit SignalScope(sightline::Context& context) {
    cancelled_flag = &context.cancelled;
    struct sigaction action = {};
    action.sa_handler = on_signal;
    // Reads and writes go on after the handler has set its flag.
    action.sa_flags = SA_RESTART;
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    signal(SIGPIPE, SIG_IGN);
  }
  ~SignalScope() { cancelled_flag = nullptr; }
  SignalScope(const SignalScope&) = delete;
  SignalScope& operator=(const SignalScope&) = delete;
};

int output_failed(const std::error_code& code) {
  if (code != std::errc::broken_pipe) fmt::print(stderr, "sightline: standard output: cannot be written: {}\n", code.message());
  return sightline::app::kResource;
}

/// What was printed must have arrived, or the exit code would lie. A reader that closed its end early (head) is told by the code alone.
int after_flushing(int code) {
  if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return code;
  const int error_number = errno;
  if (code != sightline::app::kDone) return code;
  return output_failed(std::error_code(error_number, std::generic_category()));
}

int exit_code(const sightline::Error& error) {
  switch (error.code()) {
    case sightline::ErrorCode::bug:
      return sightline::app::kBug;
    case sightline::ErrorCode::usage:
      return sightline::app::kUsage;
    case sightline::ErrorCode::input:
      return sightline::app::kInput;
    case sightline::ErrorCode::resource:
      return sightline::app::kResource;
    case sightline::ErrorCode::interrupted:
      return sightline::app::kInterrupted;
  }
  return sightline::app::kBug;
}

int run(int argc, char** argv) {
  using Command = sightline::app::CommandLine::Command;
  const auto line = sightline::app::parse_command_line(argc, argv);
  if (!line) return sightline::app::kDone;
  if (!line->common.simd.empty()) sightline::pin_simd_target(line->common.simd);
  sightline::Context context;
  context.threads = line->common.threads;
  context.seed = line->render.seed;
  sightline::app::Console console(line->common.progress, line->common.log_level);
  console.attach(context);
  const SignalScope signals(context);
  switch (line->command) {
    case Command::render:
      return run_render(*line, console, context);
    case Command::compare:
      return run_compare(*line, console, context);
    case Command::methods:
      return run_methods(*line);
    case Command::info:
      return run_info(*line, context);
    case Command::bake:
      return run_bake(*line, console, context);
    case Command::bench:
      return run_bench(*line, console, context);
    case Command::gallery:
      return run_gallery(*line);
    case Command::merge:
      return run_merge(*line, context);
    case Command::none:
      break;
  }
  return sightline::app::kUsage;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return after_flushing(run(argc, argv));
  } catch (const sightline::Error& error) {
    fmt::print(stderr, "sightline: {}\n", error.what());
    return exit_code(error);
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "sightline: out of memory; use --memory-limit, fewer layers or a smaller scene\n");
    return sightline::app::kResource;
  } catch (const std::system_error& error) {
    // Of the calls that report this way, those fail that print or want a thread.
    if (std::ferror(stdout)) return output_failed(error.code());
    fmt::print(stderr, "sightline: {}\n", error.what());
    return sightline::app::kResource;
  } catch (const std::exception& error) {
    fmt::print(stderr, "sightline: internal error: {}; please report this\n", error.what());
    return sightline::app::kBug;
  }
}
