// What a query and a miss cost in the batch path, on the batches that the view's picture asks; and what exact rays cost beside bare Embree.
//
// Replayed on one thread. A batch is first answered by a cold table, then again until nothing is traced any more: from then on all are
// hits, and keys, hashes and look-ups are all that is left to pay.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>

#include "bench/bare_loop.h"
#include "bench/visibility_cache/figures.h"
#include "bench/visibility_cache/parts.h"
#include "bench/visibility_cache/query_recorder.h"
#include "session/stopwatch.h"
#include "trace/embree/embree_tracer.h"
#include "visibility/query_rays.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kWarmRounds = 5;

/// Sums over batches.
struct Replay {
  std::uint64_t queries = 0, lookups = 0;  ///< of warm calls
  double warm_seconds = 0;
  std::uint64_t warm_traced = 0;  ///< what the table could not keep
  std::uint64_t cold_misses = 0;
  double cold_seconds = 0, miss_ray_seconds = 0;
};

double timed(const std::function<void()>& work) {
  const Stopwatch watch;
  work();
  return watch.seconds();
}

// The batch as the method leaves it: in the cache of the core.
void touch(const QueryBatch& batch) {
  volatile float sink = 0;
  for (const QueryEnds* ends : {&batch.eye, &batch.light}) {
    float sum = 0;
    for (std::size_t i = 0; i < ends->size; ++i)
      sum += ends->position.x[i] + ends->position.y[i] + ends->position.z[i] + ends->normal.x[i] + ends->normal.y[i] + ends->normal.z[i] +
             ends->error[i] + ends->cell_area[i];
    sink = sink + sum;
  }
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < batch.size; ++i) bits ^= batch.eye_of[i] ^ batch.light_of[i];
  sink = sink + static_cast<float>(bits);
}

Replay replay(const std::vector<RecordedScope>& scopes, const CacheView& view, const std::vector<std::string>& settings,
              const Context& context) {
  const VisibilityInfo& info = find_visibility("cached");
  SettingsValue value = info.settings;
  for (const std::string& setting : settings) value.apply(setting);
  const std::unique_ptr<Visibility> visibility = info.make(view.world, value, context);
  visibility->begin_pass({0, 0}, context);
  const std::unique_ptr<VisibilityWorker> worker = visibility->worker();
  QueryTracer tracer(*view.world);
  AlignedVector<float> weights;
  std::vector<std::uint32_t> some;
  Replay sum;
  for (const RecordedScope& scope : scopes) {
    context.check_cancelled();
    worker->begin(scope.scope);
    for (const QueryBatch& batch : scope.batches) {
      weights.resize(std::max(weights.size(), padded(batch.size) + kLanes));
      RayCounts rays;
      VisibilityCounts cold, settled, warm;
      touch(batch);
      const double cold_seconds = timed([&] { worker->visible(batch, weights, rays, cold); });
      for (int round = 0; round < 8; ++round) {
        const std::uint64_t before = settled.traced;
        worker->visible(batch, weights, rays, settled);
        if (settled.traced == before) break;
      }
      std::vector<double> seconds;
      for (int round = 0; round < kWarmRounds; ++round) {
        const double one = timed([&] { worker->visible(batch, weights, rays, warm); });
        seconds.push_back(one);
      }
      const double warm_seconds = median(seconds);
      sum.queries += batch.size, sum.lookups += warm.lookups / kWarmRounds;
      sum.warm_seconds += warm_seconds, sum.warm_traced += warm.traced / kWarmRounds;
      if (cold.traced == 0) continue;
      sum.cold_misses += cold.traced;
      sum.cold_seconds += cold_seconds - warm_seconds;
      // As many rays, of queries all over the batch, packed as misses are.
      some.clear();
      for (std::uint64_t k = 0; k < cold.traced; ++k)
        some.push_back(static_cast<std::uint32_t>(std::min<std::uint64_t>(batch.size - 1, k * batch.size / cold.traced)));
      sum.miss_ray_seconds += timed([&] { tracer.trace(batch, some, rays, settled); });
    }
  }
  return sum;
}

double per(double seconds, std::uint64_t count) { return count > 0 ? seconds * 1e9 / static_cast<double>(count) : 0; }

Json lookup_row(const std::string& name, const std::vector<RecordedScope>& scopes, const CacheView& view,
                const std::vector<std::string>& settings, const Context& context) {
  const Replay r = replay(scopes, view, settings, context);
  const auto queries = static_cast<double>(std::max<std::uint64_t>(1, r.queries));
  return {{"name", name},
          {"settings", settings},
          {"queries", r.queries},
          {"ns_per_query", per(r.warm_seconds, r.queries)},
          {"lookups_per_query", static_cast<double>(r.lookups) / queries},
          {"still_traced_share", static_cast<double>(r.warm_traced) / queries},
          {"misses", r.cold_misses},
          {"ns_per_miss", per(r.cold_seconds, r.cold_misses)},
          {"ns_per_miss_ray", per(r.miss_ray_seconds, r.cold_misses)},
          {"ns_per_miss_besides_ray", per(r.cold_seconds - r.miss_ray_seconds, r.cold_misses)}};
}

// The exact visibility on its own batches, and the same rays, made beforehand, in bare Embree calls.
Json exact_row(const CacheView& view, std::uint64_t most, const Context& context) {
  const std::vector<RecordedScope> scopes = record_queries(view, "exact", {}, most, context);
  const std::unique_ptr<Visibility> visibility = find_visibility("exact").make(view.world, find_visibility("exact").settings, context);
  const std::unique_ptr<VisibilityWorker> worker = visibility->worker();
  const EmbreeScenes* scenes = embree_scenes(view.world->tracer());
  // Bare calls know neither instances nor alpha masks.
  const bool comparable = scenes && scenes->static_scene && !scenes->top_scene && !(scenes->masks && scenes->masks->any());
  constexpr std::array<CallStyle, 5> kStyles = {{{1, false}, {8, false}, {8, true}, {16, false}, {16, true}}};
  AlignedVector<float> weights;
  AlignedVector<std::uint8_t> blocked;
  RayBatch batch_rays;
  std::uint64_t count = 0;
  double ours = 0;
  std::array<double, kStyles.size()> bare{};
  for (const RecordedScope& scope : scopes) {
    context.check_cancelled();
    worker->begin(scope.scope);
    for (const QueryBatch& batch : scope.batches) {
      weights.resize(std::max(weights.size(), padded(batch.size) + kLanes));
      blocked.resize(std::max(blocked.size(), padded(batch.size)));
      RayCounts rays;
      VisibilityCounts counts;
      batch_rays.resize(batch.size);
      for (std::size_t i = 0; i < batch.size; ++i) batch_rays.set(i, query_ray(batch, i));
      // All by turns, each once for warming and three times for the median.
      std::array<std::vector<double>, kStyles.size() + 1> seconds;
      for (int round = 0; round < 4; ++round) {
        const double one = timed([&] { worker->visible(batch, weights, rays, counts); });
        if (round > 0) seconds.back().push_back(one);
        for (std::size_t s = 0; s < kStyles.size() && comparable; ++s) {
          const double other = timed([&] { bare_occluded(scenes->static_scene, batch_rays, blocked.data(), kStyles[s]); });
          if (round > 0) seconds[s].push_back(other);
        }
      }
      count += batch.size;
      ours += median(seconds.back());
      for (std::size_t s = 0; s < kStyles.size() && comparable; ++s) bare[s] += median(seconds[s]);
    }
  }
  const double rate = static_cast<double>(count) * 1e-6;
  Json json = {{"rays", count}, {"exact_mray_per_s", ours > 0 ? rate / ours : 0}, {"exact_ns_per_query", per(ours, count)}};
  if (!comparable || count == 0) return json;
  const auto best = std::min_element(bare.begin(), bare.end());
  const CallStyle style = kStyles[static_cast<std::size_t>(best - bare.begin())];
  json["bare_mray_per_s"] = rate / *best;
  json["bare_style"] = fmt::format("{}{}", style.width, style.width == 1 ? "" : style.coherent ? " coherent" : " incoherent");
  json["throughput_kept"] = *best / ours;
  return json;
}

}  // namespace

Json cache_lookup(const CacheView& view, const CacheBenchOptions& options, const Context& context) {
  context.info(fmt::format("bench visibility-cache: look-ups, {}", view.name));
  const std::uint64_t most = options.quick ? 200'000 : 2'000'000;
  Json json = {{"view", view.name}, {"exact", exact_row(view, most, context)}, {"rows", Json::array()}};
  for (const int ce : {8, 36}) {
    const std::string edge = fmt::format("ce={}", ce);
    const std::vector<RecordedScope> scopes = record_queries(view, "cached", {edge}, most, context);
    json["rows"].push_back(lookup_row(fmt::format("depth 0, C_E = {}", ce), scopes, view, {edge, "refine=none"}, context));
    json["rows"].push_back(lookup_row(fmt::format("refined, 4 neighbours, C_E = {}", ce), scopes, view, {edge, "refine=4"}, context));
  }
  return json;
}

}  // namespace sightline
