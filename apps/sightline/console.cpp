#include "console.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

namespace sightline::app {
namespace {

LogLevel level_from_name(const std::string& name) {
  if (name == "debug") return LogLevel::debug;
  if (name == "warning") return LogLevel::warning;
  if (name == "error") return LogLevel::error;
  return LogLevel::info;
}

std::string_view prefix(LogLevel level, bool color) {
  switch (level) {
    case LogLevel::debug:
      return color ? "\033[2mdebug:\033[0m " : "debug: ";
    case LogLevel::info:
      return "";
    case LogLevel::warning:
      return color ? "\033[33mwarning:\033[0m " : "warning: ";
    case LogLevel::error:
      return color ? "\033[31merror:\033[0m " : "error: ";
  }
  return "";
}

}  // namespace

Console::Console(const std::string& progress, const std::string& level) : level_(level_from_name(level)) {
  const bool terminal = isatty(STDERR_FILENO) == 1;
  const char* no_color = std::getenv("NO_COLOR");
  color_ = terminal && (!no_color || !*no_color);
  if (progress == "bar" || (progress == "auto" && terminal)) kind_ = ProgressKind::bar;
  if (progress == "plain" || (progress == "auto" && !terminal)) kind_ = ProgressKind::plain;
  if (progress == "json") kind_ = ProgressKind::json;
  // A plain line for every short phase would be noise; the first one waits a few seconds.
  last_ = start_;
}

Console::~Console() { finish(); }

void Console::attach(Context& context) {
  context.log = [this](LogLevel level, std::string_view text) { log(level, text); };
  if (kind_ != ProgressKind::none) context.progress = [this](const Progress& p) { progress(p); };
}

void Console::log(LogLevel level, std::string_view text) {
  if (level < level_) return;
  const std::lock_guard lock(mutex_);
  if (bar_shown_) std::fputs("\r\033[K", stderr), bar_shown_ = false;
  fmt::print(stderr, "{}{}\n", prefix(level, color_), text);
}

bool Console::due(double interval_s) {
  const auto now = std::chrono::steady_clock::now();
  if (std::chrono::duration<double>(now - last_).count() < interval_s) return false;
  last_ = now;
  return true;
}

void Console::progress(const Progress& progress) {
  const std::lock_guard lock(mutex_);
  if (!due(kind_ == ProgressKind::bar ? 0.1 : kind_ == ProgressKind::json ? 0.25 : 5)) return;
  double fraction = progress.total > 0 ? progress.done / progress.total : 0;
  if (progress.phase == "render") fraction = sample_fraction_ + sample_share_ * fraction;
  draw(progress.phase, std::clamp(fraction, 0.0, 1.0), "");
}

void Console::rendered(std::uint32_t samples, std::uint32_t total, double seconds, const RayCounts& rays) {
  const std::lock_guard lock(mutex_);
  sample_fraction_ = total ? static_cast<double>(samples) / total : 1;
  sample_share_ = std::max(0.0, std::min(sample_fraction_, 1 - sample_fraction_));
  if (kind_ == ProgressKind::none || !due(kind_ == ProgressKind::bar ? 0.1 : kind_ == ProgressKind::json ? 0 : 5)) return;
  const double eta = sample_fraction_ > 0 ? seconds * (1 - sample_fraction_) / sample_fraction_ : 0;
  const double rate = seconds > 0 ? static_cast<double>(rays.closest + rays.occlusion) / seconds : 0;
  if (kind_ == ProgressKind::json) {
    const nlohmann::ordered_json line = {{"phase", "render"}, {"percent", 100 * sample_fraction_}, {"spp", samples},
                                         {"eta", eta},        {"rays_per_second", rate},           {"bytes", current_resident_bytes()}};
    fmt::print(stderr, "{}\n", line.dump());
    return;
  }
  draw("render", sample_fraction_, fmt::format("{}/{} spp, {:.1f} Mray/s, {:.0f} s left", samples, total, rate * 1e-6, eta));
}

void Console::draw(std::string_view phase, double fraction, std::string_view detail) {
  if (kind_ == ProgressKind::json) {
    const nlohmann::ordered_json line = {{"phase", phase}, {"percent", 100 * fraction}, {"bytes", current_resident_bytes()}};
    fmt::print(stderr, "{}\n", line.dump());
  } else if (kind_ == ProgressKind::plain) {
    fmt::print(stderr, "{} {:.0f} % {}\n", phase, 100 * fraction, detail);
  } else {
    constexpr int kWidth = 30;
    const int filled = static_cast<int>(fraction * kWidth);
    fmt::print(stderr, "\r\033[K{:<8}[{}{}] {:3.0f} % {}", phase, std::string(static_cast<std::size_t>(filled), '='),
               std::string(static_cast<std::size_t>(kWidth - filled), ' '), 100 * fraction, detail);
    std::fflush(stderr);
    bar_shown_ = true;
  }
}

void Console::finish() {
  const std::lock_guard lock(mutex_);
  if (bar_shown_) std::fputs("\r\033[K", stderr), std::fflush(stderr), bar_shown_ = false;
}

}  // namespace sightline::app
