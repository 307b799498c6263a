#include "visibility/cached/cached.h"

#include <memory>
#include <utility>

#include "visibility/cached/core.h"
#include "visibility/cached/worker.h"

namespace sightline {
namespace {

class CachedVisibility final : public Visibility {
 public:
  CachedVisibility(std::shared_ptr<const World> world, const CachedVisibilitySettings& settings)
      : core_(std::make_shared<CacheCore>(std::move(world), settings)) {}
  bool binary() const override { return core_->settings.residual == 0; }
  void begin_pass(const VisibilityPass& pass, const Context&) override { core_->pass = pass; }
  std::unique_ptr<VisibilityWorker> worker() override { return std::make_unique<CachedWorker>(core_); }
  std::uint64_t memory_bytes() const override { return core_->bytes; }

 private:
  std::shared_ptr<CacheCore> core_;
};

}  // namespace

VisibilityInfo cached_visibility() {
  VisibilityInfo info;
  info.name = "cached";
  info.help = "adaptive quantization cache: one ray for all queries of a cluster";
  info.citation = "Popov2013";
  info.unbiased = false;
  info.settings = SettingsValue::of<CachedVisibilitySettings>();
  info.make = [](std::shared_ptr<const World> world, const SettingsValue& settings, const Context&) -> std::unique_ptr<Visibility> {
    return std::make_unique<CachedVisibility>(std::move(world), settings.as<CachedVisibilitySettings>());
  };
  return info;
}

}  // namespace sightline
