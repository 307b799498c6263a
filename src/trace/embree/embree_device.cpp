#include "trace/embree/embree_device.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "base/core/error.h"

namespace sightline {
namespace {

// Embree's own setting would install a tbb::global_control that throttles the whole process for as long as the device lives; a device made
// in an arena (run_in_arena) takes the arena's size instead. Where parallel loops do not run on TBB (ThreadSanitizer), one thread builds.
#if SIGHTLINE_PARALLEL_TBB
constexpr const char* kThreadSetting = "";
#else
constexpr const char* kThreadSetting = ",threads=1";
#endif

}  // namespace

EmbreeDevice::EmbreeDevice(const std::string& isa) {
  // Without its configuration files Embree behaves the same for every user and folder.
  std::string settings = std::string("ignore_config_files=1") + kThreadSetting;
  // Embree silently ignores names that it does not know.
  constexpr std::array<std::string_view, 5> kInstructionSets{"sse2", "sse4.2", "avx", "avx2", "avx512"};
  if (!isa.empty() && std::find(kInstructionSets.begin(), kInstructionSets.end(), isa) == kInstructionSets.end()) {
    throw usage_error(fmt::format("unknown instruction set '{}'", isa)).remedy("use sse2, sse4.2, avx, avx2 or avx512");
  }
  if (!isa.empty()) settings += ",isa=" + isa;
  device_ = rtcNewDevice(settings.c_str());
  if (!device_) {
    throw usage_error(fmt::format("Embree cannot be started with '{}' (error {})", settings, static_cast<int>(rtcGetDeviceError(nullptr))));
  }
  rtcSetDeviceErrorFunction(device_, on_error, this);
  rtcSetDeviceMemoryMonitorFunction(device_, on_memory, this);
  const auto has = [&](RTCDeviceProperty property) { return rtcGetDeviceProperty(device_, property) != 0; };
  native_width_ = has(RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED)  ? 16
                  : has(RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) ? 8
                  : has(RTC_DEVICE_PROPERTY_NATIVE_RAY4_SUPPORTED) ? 4
                                                                   : 1;
}

EmbreeDevice::~EmbreeDevice() { rtcReleaseDevice(device_); }

bool EmbreeDevice::on_memory(void* self, ssize_t bytes, bool post) {
  auto& device = *static_cast<EmbreeDevice*>(self);
  const std::int64_t now = device.bytes_.fetch_add(bytes, std::memory_order_relaxed) + bytes;
  std::int64_t peak = device.peak_bytes_.load(std::memory_order_relaxed);
  while (now > peak && !device.peak_bytes_.compare_exchange_weak(peak, now, std::memory_order_relaxed)) {
  }
  // Only a request can be refused; it is then not made, and so not counted.
  const std::int64_t budget = device.budget_bytes_.load(std::memory_order_relaxed);
  if (post || bytes <= 0 || budget == 0 || now <= budget) return true;
  device.bytes_.fetch_sub(bytes, std::memory_order_relaxed);
  return false;
}

void EmbreeDevice::on_error(void* self, RTCError code, const char* text) {
  auto& device = *static_cast<EmbreeDevice*>(self);
  const std::lock_guard lock(device.error_mutex_);
  if (device.error_ != RTC_ERROR_NONE) return;  // the first one says why
  device.error_ = code;
  device.error_text_ = text ? text : "";
}

EmbreeDevice::Build::Build(EmbreeDevice& device, const Context& context, std::uint64_t other_bytes)
    : device_(device), context_(context), other_bytes_(other_bytes), lock_(device.build_mutex_) {
  device_.peak_bytes_.store(device_.bytes());
  // A budget of 0 would be none; nothing that is built fits in one byte.
  const std::uint64_t limit = context.memory_budget_bytes;
  device_.budget_bytes_.store(limit == 0 ? 0 : static_cast<std::int64_t>(std::max<std::uint64_t>(limit - std::min(limit, other_bytes), 1)));
  const std::lock_guard lock(device_.error_mutex_);
  device_.error_ = RTC_ERROR_NONE;
}

EmbreeDevice::Build::~Build() { device_.budget_bytes_.store(0); }

Error EmbreeDevice::Build::out_of_memory() const {
  constexpr double gib = 1u << 30;
  const auto in_gib = [](std::uint64_t bytes) { return static_cast<double>(bytes) / gib; };
  const std::string held = fmt::format("the acceleration structure does not fit: {:.2f} GiB of it are built",
                                       in_gib(static_cast<std::uint64_t>(std::max<std::int64_t>(device_.bytes(), 0))));
  if (context_.memory_budget_bytes == 0) return resource_error(held).remedy("use a smaller scene");
  return resource_error(fmt::format("{}, scene and picture take {:.2f} GiB, and the memory limit is {:.2f} GiB", held, in_gib(other_bytes_),
                                    in_gib(context_.memory_budget_bytes)))
      .remedy("raise --memory-limit or use a smaller scene");
}

void EmbreeDevice::Build::check() {
  context_.check_cancelled();
  const std::lock_guard lock(device_.error_mutex_);
  const RTCError code = std::exchange(device_.error_, RTC_ERROR_NONE);
  switch (code) {
    case RTC_ERROR_NONE:
      return;
    case RTC_ERROR_OUT_OF_MEMORY:
      throw out_of_memory();
    case RTC_ERROR_CANCELLED:
      throw Error(ErrorCode::interrupted, "cancelled");
    case RTC_ERROR_UNSUPPORTED_CPU:
      throw usage_error("Embree does not support this CPU: " + device_.error_text_);
    default:
      throw Error(ErrorCode::bug, fmt::format("Embree error {}: {}", static_cast<int>(code), device_.error_text_));
  }
}

}  // namespace sightline
