// What the program says on stderr: log lines and progress.
#pragma once

#include <chrono>
#include <mutex>
#include <string>

#include "base/core/context.h"
#include "session/render.h"

namespace sightline::app {

/// Log sink and progress display in one, since a bar and log lines share the terminal. Thread-safe.
class Console {
 public:
  enum class ProgressKind { none, bar, plain, json };

  /// `progress`: auto, bar, plain, json, none; `level`: debug, info, warning, error.
  Console(const std::string& progress, const std::string& level);
  ~Console();

  /// Connects log and progress of a context to this console.
  void attach(Context& context);
  void log(LogLevel level, std::string_view text);
  void progress(const Progress& progress);
  /// Progress over all passes of one picture.
  void rendered(std::uint32_t samples, std::uint32_t total, double seconds, const RayCounts& rays);
  /// Removes the bar.
  void finish();

 private:
  bool due(double interval_s);
  void draw(std::string_view phase, double fraction, std::string_view detail);

  ProgressKind kind_ = ProgressKind::none;
  LogLevel level_ = LogLevel::info;
  bool color_ = false, bar_shown_ = false;
  double sample_fraction_ = 0, sample_share_ = 0;
  std::mutex mutex_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now(), last_{};
};

}  // namespace sightline::app
