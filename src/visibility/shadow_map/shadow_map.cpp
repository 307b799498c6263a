#include "visibility/shadow_map/shadow_map.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <utility>

#include "base/core/error.h"
#include "base/parallel/parallel.h"
#include "visibility/query_rays.h"
#include "visibility/shadow_map/light_maps.h"
#include "visibility/shadow_map/settings.h"

namespace sightline {
namespace {

// Depth bias: two texels' width on a slope that hides `cosine`, and a part of the scene.
constexpr float kBiasTexels = 2, kBiasOfRadius = 1e-4f;

std::uint64_t machine_bytes() {
  return static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

/// What filling has cost since someone asked.
class FillingCost {
 public:
  void add(const RayCounts& rays, std::chrono::steady_clock::duration time) {
    rays_ += rays.closest;
    nanoseconds_ += static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(time).count());
  }
  void move_to(RayCounts& rays, VisibilityCounts& counts) {
    if (rays_.load(std::memory_order_relaxed) == 0) return;
    const std::uint64_t traced = rays_.exchange(0);
    rays.closest += traced;
    counts.filling += traced;
    counts.filling_seconds += 1e-9 * static_cast<double>(nanoseconds_.exchange(0));
  }

 private:
  std::atomic<std::uint64_t> rays_{0}, nanoseconds_{0};
};

/// What all workers share.
struct Shared {
  Shared(std::shared_ptr<const World> of_world, std::uint32_t resolution)
      : world(std::move(of_world)),
        lights(world->scene(), world->bounds(), resolution),
        constant_bias(kBiasOfRadius * world->bounds().half_diagonal()) {}

  /// Fills a tile of a map unless another thread has.
  void fill(const DepthMap& map, std::size_t tile, DepthMap::Filler& filler) {
    if (tile_bytes.load(std::memory_order_relaxed) > budget_bytes)
      throw resource_error("shadow maps do not fit in memory").remedy("lower --set resolution or raise --memory-limit");
    const auto start = std::chrono::steady_clock::now();
    RayCounts traced;
    if (!map.fill(tile, world->tracer(), filler, traced)) return;
    tile_bytes += DepthMap::kTileTexels * sizeof(float);
    cost.add(traced, std::chrono::steady_clock::now() - start);
  }

  std::shared_ptr<const World> world;
  LightMaps lights;
  float constant_bias;
  std::uint64_t budget_bytes = 0;
  std::atomic<std::uint64_t> tile_bytes{0};
  FillingCost cost;
};

class ShadowMapWorker final : public VisibilityWorker {
 public:
  explicit ShadowMapWorker(Shared& shared) : shared_(shared), tracer_(*shared.world) {}
  void begin(std::uint32_t) override {}
  void visible(const QueryBatch& queries, std::span<float> weights, RayCounts& rays, VisibilityCounts& counts) override;

 private:
  struct Missing {
    std::uint32_t query, map;
    std::size_t texel;
    float distance;  ///< bias taken off
  };
  void find_maps(const QueryBatch& queries);

  Shared& shared_;
  QueryTracer tracer_;
  AlignedVector<std::uint32_t> map_of_;  ///< of each light end
  std::vector<std::uint32_t> exact_;
  std::vector<Missing> missing_;
  DepthMap::Filler filler_;
};

void ShadowMapWorker::find_maps(const QueryBatch& queries) {
  const QueryEnds& ends = queries.light;
  map_of_.resize(std::max(map_of_.size(), ends.size));
  for (std::size_t l = 0; l < ends.size; ++l)
    map_of_[l] = shared_.lights.find(static_cast<QuerySemantic>(queries.semantic[l]),
                                     Vec3(ends.position.x[l], ends.position.y[l], ends.position.z[l]));
}

void ShadowMapWorker::visible(const QueryBatch& queries, std::span<float> weights, RayCounts& rays, VisibilityCounts& counts) {
  find_maps(queries);
  exact_.clear(), missing_.clear();
  const std::vector<DepthMap>& maps = shared_.lights.maps();
  const QueryEnds& eyes = queries.eye;
  std::uint64_t looked_up = 0;
  for (std::size_t i = 0; i < queries.size; ++i) {
    weights[i] = 0;
    if (queries.light_of[i] == kNoQuery) continue;
    const std::uint32_t map = map_of_[queries.light_of[i]];
    if (map == LightMaps::kNone) {
      exact_.push_back(static_cast<std::uint32_t>(i));
      continue;
    }
    ++looked_up;
    const std::size_t e = queries.eye_of[i];
    const Vec3 normal(eyes.normal.x[e], eyes.normal.y[e], eyes.normal.z[e]);
    const DepthMap::Place place = maps[map].locate({eyes.position.x[e], eyes.position.y[e], eyes.position.z[e]}, normal);
    // A receiver that leans away from the light changes its distance by the tangent for each texel's width; points in space do not.
    const bool leans = normal != Vec3(0);
    const float cosine = std::clamp(place.cosine, 1e-4f, 1.f);
    const float slope = leans ? std::sqrt(1 - cosine * cosine) / cosine : 0.f;
    const float distance = place.distance - (kBiasTexels * place.footprint * slope + shared_.constant_bias);
    const float depth = maps[map].depth(place.texel);
    if (depth > 0)
      weights[i] = distance <= depth ? 1.f : 0.f;
    else
      missing_.push_back({static_cast<std::uint32_t>(i), map, place.texel, distance});
  }
  for (const Missing& missing : missing_) {
    const DepthMap& map = maps[missing.map];
    if (map.depth(missing.texel) == 0) shared_.fill(map, DepthMap::tile_of(missing.texel), filler_);
    weights[missing.query] = missing.distance <= map.depth(missing.texel) ? 1.f : 0.f;
  }
  const std::span<const std::uint8_t> occluded = tracer_.trace(queries, exact_, rays, counts);
  for (std::size_t k = 0; k < exact_.size(); ++k) weights[exact_[k]] = occluded[k] ? 0.f : 1.f;
  counts.queries += looked_up + exact_.size();
  counts.cached += looked_up;
  counts.lookups += looked_up;
  shared_.cost.move_to(rays, counts);
}

class ShadowMapVisibility final : public Visibility {
 public:
  ShadowMapVisibility(std::shared_ptr<const World> world, const ShadowMapSettings& settings, const Context& context);
  void begin_pass(const VisibilityPass&, const Context& context) override;
  std::unique_ptr<VisibilityWorker> worker() override { return std::make_unique<ShadowMapWorker>(shared_); }
  std::uint64_t memory_bytes() const override { return shared_.tile_bytes.load(); }

 private:
  Shared shared_;
  bool whole_;
};

ShadowMapVisibility::ShadowMapVisibility(std::shared_ptr<const World> world, const ShadowMapSettings& settings, const Context& context)
    : shared_(std::move(world), static_cast<std::uint32_t>(settings.resolution)) {
  // Without a limit, most of the machine: an error is kinder than a machine that swaps.
  const std::uint64_t limit = context.memory_budget_bytes > 0 ? context.memory_budget_bytes : machine_bytes() / 4 * 3;
  shared_.budget_bytes = limit - std::min(limit, current_resident_bytes());
  const bool fits = shared_.lights.bytes_when_full() <= (context.memory_budget_bytes > 0 ? shared_.budget_bytes : machine_bytes() / 2);
  using Fill = ShadowMapSettings::Fill;
  if (settings.fill == Fill::whole && !fits)
    throw resource_error("whole shadow maps do not fit in memory").remedy("use --set fill=on-demand or lower --set resolution");
  whole_ = fits && settings.fill != Fill::on_demand;
}

void ShadowMapVisibility::begin_pass(const VisibilityPass&, const Context& context) {
  if (!std::exchange(whole_, false)) return;
  const std::vector<DepthMap>& maps = shared_.lights.maps();
  std::vector<DepthMap::Filler> fillers(static_cast<std::size_t>(context.thread_count()));
  for (std::size_t m = 0; m < maps.size(); ++m) {
    context.report("shadow maps", static_cast<double>(m), static_cast<double>(maps.size()));
    constexpr std::size_t kTilesATask = 16;
    parallel_for(context, maps[m].tile_count(), kTilesATask, [&](std::size_t begin, std::size_t end) {
      DepthMap::Filler& filler = fillers[static_cast<std::size_t>(worker_index()) % fillers.size()];
      for (std::size_t tile = begin; tile < end; ++tile) shared_.fill(maps[m], tile, filler);
    });
  }
}

}  // namespace

VisibilityInfo shadow_map_visibility() {
  VisibilityInfo info;
  info.name = "shadow-map";
  info.help =
      "plain shadow maps for point, spot and directional lights: one unfiltered look-up a query; a ray where the light is an area, a "
      "virtual "
      "point light or the environment";
  info.citation = "Williams1978";
  info.unbiased = false;
  info.settings = SettingsValue::of<ShadowMapSettings>();
  info.make = [](std::shared_ptr<const World> world, const SettingsValue& settings, const Context& context) -> std::unique_ptr<Visibility> {
    return std::make_unique<ShadowMapVisibility>(std::move(world), settings.as<ShadowMapSettings>(), context);
  };
  return info;
}

}  // namespace sightline
