#include "visibility/shadow_map/shadow_map.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <utility>

#include "base/core/error.h"
#include "base/parallel/parallel.h"
#include "visibility/query_rays.h"
#include "visibility/shadow_map/cube_lanes.h"
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
  static constexpr std::size_t kBlock = CubeLanes::kSize;
  struct Asked {
    std::uint32_t query, map, texel;
    float distance;  ///< bias taken off
  };
  void find_maps(const QueryBatch& queries);
  /// Queries [begin, end): the weights of those whose texel is filled, and lists of the others. Returns how many have a map.
  std::uint64_t look_up(const QueryBatch& queries, std::size_t begin, std::size_t end, std::span<float> weights);

  Shared& shared_;
  QueryTracer tracer_;
  AlignedVector<std::uint32_t> map_of_;  ///< of each light end
  std::vector<std::uint32_t> exact_;
  CubeLanes lanes_{};
  std::array<Asked, kBlock> cube_{}, asked_{};
  std::vector<Asked> missing_;  ///< whose tile is not filled
  DepthMap::Filler filler_;
};

void ShadowMapWorker::find_maps(const QueryBatch& queries) {
  const QueryEnds& ends = queries.light;
  map_of_.resize(std::max(map_of_.size(), ends.size));
  for (std::size_t l = 0; l < ends.size; ++l)
    map_of_[l] = shared_.lights.find(static_cast<QuerySemantic>(queries.semantic[l]),
                                     Vec3(ends.position.x[l], ends.position.y[l], ends.position.z[l]));
}

std::uint64_t ShadowMapWorker::look_up(const QueryBatch& queries, std::size_t begin, std::size_t end, std::span<float> weights) {
  const std::vector<DepthMap>& maps = shared_.lights.maps();
  const QueryEnds& eyes = queries.eye;
  std::size_t cubes = 0, count = 0;
  for (std::size_t i = begin; i < end; ++i) {
    weights[i] = 0;
    const std::uint32_t l = queries.light_of[i];
    if (l == kNoQuery) continue;
    if (map_of_[l] == LightMaps::kNone) {
      exact_.push_back(static_cast<std::uint32_t>(i));
      continue;
    }
    const std::size_t e = queries.eye_of[i];
    const DepthMap& map = maps[map_of_[l]];
    if (const Vec3* center = map.center()) {
      lanes_.x[cubes] = eyes.position.x[e] - center->x, lanes_.nx[cubes] = eyes.normal.x[e];
      lanes_.y[cubes] = eyes.position.y[e] - center->y, lanes_.ny[cubes] = eyes.normal.y[e];
      lanes_.z[cubes] = eyes.position.z[e] - center->z, lanes_.nz[cubes] = eyes.normal.z[e];
      cube_[cubes++] = {static_cast<std::uint32_t>(i), map_of_[l], 0, 0};
      continue;
    }
    const DepthMap::Place place =
        map.locate({eyes.position.x[e], eyes.position.y[e], eyes.position.z[e]}, {eyes.normal.x[e], eyes.normal.y[e], eyes.normal.z[e]});
    asked_[count++] = {static_cast<std::uint32_t>(i), map_of_[l], static_cast<std::uint32_t>(place.texel),
                       place.distance - (kBiasTexels * place.change + shared_.constant_bias)};
  }
  if (cubes > 0) {
    const DepthMap& any = maps[cube_[0].map];
    lanes_.locate(any.resolution(), any.tiles_across());
  }
  for (std::size_t k = 0; k < cubes; ++k, ++count) {
    asked_[count] = cube_[k];
    asked_[count].texel = lanes_.texel[k];
    asked_[count].distance = lanes_.distance[k] - (kBiasTexels * lanes_.change[k] + shared_.constant_bias);
  }
  for (const Asked& asked : std::span(asked_).first(count)) maps[asked.map].prefetch(asked.texel);
  for (const Asked& asked : std::span(asked_).first(count)) {
    const float depth = maps[asked.map].depth(asked.texel);
    weights[asked.query] = asked.distance <= depth ? 1.f : 0.f;
    if (depth == 0) missing_.push_back(asked);
  }
  return count;
}

void ShadowMapWorker::visible(const QueryBatch& queries, std::span<float> weights, RayCounts& rays, VisibilityCounts& counts) {
  find_maps(queries);
  exact_.clear(), missing_.clear();
  std::uint64_t looked_up = 0;
  // In blocks: first all places, so that their texels are on the way, then the texels.
  for (std::size_t begin = 0; begin < queries.size; begin += kBlock)
    looked_up += look_up(queries, begin, std::min(queries.size, begin + kBlock), weights);
  const std::vector<DepthMap>& maps = shared_.lights.maps();
  for (const Asked& missing : missing_) {
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
