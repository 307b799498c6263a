#include "visibility/exact/exact.h"

#include <utility>

#include "visibility/query_rays.h"

namespace sightline {
namespace {

class ExactWorker final : public VisibilityWorker {
 public:
  explicit ExactWorker(const World& world) : tracer_(world) {}
  void begin(std::uint32_t) override {}
  bool exact() const override { return true; }
  void visible(const QueryBatch& queries, std::span<float> weights, RayCounts& rays, VisibilityCounts& counts) override {
    tracer_.trace_all(queries, weights, rays, counts);
  }

 private:
  QueryTracer tracer_;
};

class ExactVisibility final : public Visibility {
 public:
  explicit ExactVisibility(std::shared_ptr<const World> world) : world_(std::move(world)) {}
  bool exact() const override { return true; }
  std::unique_ptr<VisibilityWorker> worker() override { return std::make_unique<ExactWorker>(*world_); }

 private:
  std::shared_ptr<const World> world_;
};

}  // namespace

VisibilityInfo exact_visibility() {
  VisibilityInfo info;
  info.name = "exact";
  info.help = "one shadow ray a query";
  info.settings = SettingsValue::of<ExactVisibilitySettings>();
  info.make = [](std::shared_ptr<const World> world, const SettingsValue&, const Context&) -> std::unique_ptr<Visibility> {
    return std::make_unique<ExactVisibility>(std::move(world));
  };
  return info;
}

}  // namespace sightline
