#include "visibility/cached/cached.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <utility>

#include "visibility/cached/core.h"
#include "visibility/cached/separate_wave.h"
#include "visibility/cached/wave.h"
#include "visibility/cached/worker.h"

namespace sightline {
namespace {

class CachedVisibility final : public Visibility {
 public:
  CachedVisibility(std::shared_ptr<const World> world, const CachedVisibilitySettings& settings)
      : core_(std::make_shared<CacheCore>(std::move(world), settings)) {}
  bool binary() const override { return core_->settings.residual == 0; }
  bool passes_are_independent() const override { return core_->settings.scope != CacheScope::frame && !core_->settings.reuse; }
  float cluster_edge() const override { return core_->settings.ce; }
  void begin_pass(const VisibilityPass& pass, const Context& context) override {
    const CachedVisibilitySettings& s = core_->settings;
    const bool keeps = s.reuse || (s.scope == CacheScope::frame && pass.frame == core_->pass.frame);
    core_->pass = pass;
    if (shared_ && !keeps) shared_->clear(context);
  }
  std::unique_ptr<VisibilityWorker> worker() override { return std::make_unique<CachedWorker>(core_); }
  std::unique_ptr<VisibilityWave> wave(std::size_t slots) override {
    const CachedVisibilitySettings& s = core_->settings;
    if (s.scope == CacheScope::tile) return std::make_unique<SeparateWave>(core_, slots);
    const std::lock_guard lock(mutex_);
    if (!shared_) {
      shared_ = std::make_shared<SharedTable>(s.shared_table_bits);
      core_->bytes += shared_->table().bytes();
    }
    const bool of_pass = s.scope == CacheScope::pass && !s.reuse;
    const CacheSalt salt = core_->salt(of_pass ? core_->pass.first_sample : 0, s.reuse ? 0 : core_->pass.frame, kSharedScope);
    return std::make_unique<CachedWave>(core_, shared_, salt, slots);
  }
  std::uint64_t memory_bytes() const override { return core_->bytes; }

 private:
  static constexpr std::uint32_t kSharedScope = 0xffffffffu;

  std::shared_ptr<CacheCore> core_;
  std::shared_ptr<SharedTable> shared_;
  std::mutex mutex_;  // of shared_ itself; waves of one time use it in turn
};

// Tables of all threads, or the shared one: a method uses one kind or the other.
std::uint64_t table_bytes(const SettingsValue& value, const Context& context) {
  const auto& s = value.as<CachedVisibilitySettings>();
  const std::uint64_t own = (std::uint64_t{sizeof(std::uint32_t)} << s.table_bits) * static_cast<std::uint64_t>(context.thread_count());
  const std::uint64_t shared = std::uint64_t{sizeof(std::uint32_t)} << s.shared_table_bits;
  return std::max(own, shared);
}

}  // namespace

VisibilityInfo cached_visibility() {
  VisibilityInfo info;
  info.name = "cached";
  info.help = "adaptive quantization cache: one ray for all queries of a cluster";
  info.citation = "Popov2013";
  info.unbiased = false;
  info.settings = SettingsValue::of<CachedVisibilitySettings>();
  info.table_bytes = table_bytes;
  info.make = [](std::shared_ptr<const World> world, const SettingsValue& settings, const Context&) -> std::unique_ptr<Visibility> {
    return std::make_unique<CachedVisibility>(std::move(world), settings.as<CachedVisibilitySettings>());
  };
  return info;
}

}  // namespace sightline
