#include "visibility/exact/exact.h"

#include <algorithm>
#include <array>
#include <limits>

#include "base/core/aligned.h"

namespace sightline {
namespace {

class ExactVisibility final : public Visibility {
 public:
  explicit ExactVisibility(std::shared_ptr<const World> world) : world_(std::move(world)) {}

  void visible(std::span<const Query> queries, std::span<float> weights, RayCounts& rays, VisibilityCounts& counts) const override {
    constexpr std::size_t kBlock = 1024;
    RayBatch batch;
    alignas(kCacheLine) std::array<std::uint8_t, kBlock> blocked;
    for (std::size_t begin = 0; begin < queries.size(); begin += kBlock) {
      const std::size_t count = std::min(kBlock, queries.size() - begin);
      batch.resize(count);
      for (std::size_t i = 0; i < count; ++i) batch.set(i, ray_of(queries[begin + i]));
      world_->tracer().occluded(batch, blocked, BatchKind::shadow, rays);
      for (std::size_t i = 0; i < count; ++i) weights[begin + i] = blocked[i] ? 0.f : 1.f;
    }
    counts.queries += queries.size();
    counts.traced += queries.size();
  }
  bool binary() const override { return true; }

 private:
  static Ray ray_of(const Query& q) {
    if (q.semantic == QuerySemantic::direction || q.semantic == QuerySemantic::solid_angle)
      return {offset_origin(q.x, q.x_normal, q.x_error, q.y), 0, q.y, std::numeric_limits<float>::infinity()};
    const Vec3 towards = q.y - q.x;
    const Vec3 origin = offset_origin(q.x, q.x_normal, q.x_error, towards);
    const Vec3 target = offset_origin(q.y, q.y_normal, q.y_error, -towards);
    return {origin, 0, target - origin, 1};
  }

  std::shared_ptr<const World> world_;
};

}  // namespace

VisibilityInfo exact_visibility() {
  return {"exact", "one shadow ray a query", SettingsValue::of<ExactVisibilitySettings>(),
          [](std::shared_ptr<const World> world, const SettingsValue&) -> std::unique_ptr<Visibility> {
            return std::make_unique<ExactVisibility>(std::move(world));
          }};
}

}  // namespace sightline
