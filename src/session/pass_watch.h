// Ends passes in time: at a deadline, or a little after the user's Ctrl-C.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "base/core/context.h"

namespace sightline {

/// Lends passes a Context of their own. Its flag rises at the deadline, and `grace_s` after the user's flag: a pass that is nearly done is
/// worth waiting for, a long one is not. Complete tiles count either way.
class PassWatch {
 public:
  PassWatch(const Context& user, std::optional<double> seconds_left, double grace_s);
  ~PassWatch();
  PassWatch(const PassWatch&) = delete;
  PassWatch& operator=(const PassWatch&) = delete;

  const Context& context() const { return context_; }
  bool interrupted() const { return user_.cancelled.load(); }

 private:
  using Clock = std::chrono::steady_clock;
  void watch();

  const Context& user_;
  Context context_;
  std::optional<Clock::time_point> deadline_;
  Clock::duration grace_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool finished_ = false;
  std::thread thread_;
};

}  // namespace sightline
