// An Embree device that counts its memory and turns errors into exceptions.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "base/core/context.h"
#include "base/core/error.h"
#include "trace/embree/embree_compat.h"

namespace sightline {

/// Owned jointly by the committed scenes that were made with it, across all versions of a World.
class EmbreeDevice {
 public:
  explicit EmbreeDevice(const std::string& isa);
  ~EmbreeDevice();
  EmbreeDevice(const EmbreeDevice&) = delete;
  EmbreeDevice& operator=(const EmbreeDevice&) = delete;

  RTCDevice get() const { return device_; }
  /// Widest packet (1, 4, 8 or 16) that the device traces without splitting it.
  int native_width() const { return native_width_; }
  std::int64_t bytes() const { return bytes_.load(std::memory_order_relaxed); }

  /// One build at a time: while it lives, allocations count against its budget and errors are its errors.
  class Build {
   public:
    /// Of the context's memory budget, `other_bytes` are held by others.
    Build(EmbreeDevice& device, const Context& context, std::uint64_t other_bytes);
    ~Build();
    /// Throws what went wrong since the last check: Error{resource}, {interrupted} or {bug}.
    void check();
    const Context& context() const { return context_; }
    std::uint64_t peak_bytes() const { return static_cast<std::uint64_t>(device_.peak_bytes_.load(std::memory_order_relaxed)); }

   private:
    Error out_of_memory() const;

    EmbreeDevice& device_;
    const Context& context_;
    std::uint64_t other_bytes_;
    std::unique_lock<std::mutex> lock_;
  };

 private:
  static bool on_memory(void* self, ssize_t bytes, bool post);
  static void on_error(void* self, RTCError code, const char* text);

  RTCDevice device_ = nullptr;
  int native_width_ = 1;
  std::atomic<std::int64_t> bytes_{0}, peak_bytes_{0}, budget_bytes_{0};
  std::mutex build_mutex_, error_mutex_;
  RTCError error_ = RTC_ERROR_NONE;
  std::string error_text_;
};

}  // namespace sightline
