#include "session/pass_watch.h"

namespace sightline {
namespace {

// How soon a signal is noticed: a signal handler can only set a flag, so it is looked at now and then.
constexpr std::chrono::milliseconds kInterval{10};

}  // namespace

PassWatch::PassWatch(const Context& user, std::optional<double> seconds_left, double grace_s)
    : user_(user), grace_(std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(grace_s))) {
  context_.threads = user.threads;
  context_.memory_budget_bytes = user.memory_budget_bytes;
  context_.seed = user.seed;
  context_.log = user.log;
  context_.progress = user.progress;
  // Beyond a year, a time limit is none (and would not fit the clock).
  if (seconds_left && *seconds_left < 3e7)
    deadline_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(*seconds_left));
  // A deadline that has passed already is no race against the first pass.
  if (deadline_ && Clock::now() >= *deadline_) context_.cancelled.store(true);
  thread_ = std::thread([this] { watch(); });
}

PassWatch::~PassWatch() {
  {
    const std::lock_guard lock(mutex_);
    finished_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void PassWatch::watch() {
  std::optional<Clock::time_point> end = deadline_;
  bool noticed = false;
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, kInterval, [this] { return finished_; })) {
    if (!noticed && user_.cancelled.load()) {
      noticed = true;
      const Clock::time_point after_grace = Clock::now() + grace_;
      if (!end || after_grace < *end) end = after_grace;
    }
    if (end && Clock::now() >= *end) {
      context_.cancelled.store(true);
      return;
    }
  }
}

}  // namespace sightline
