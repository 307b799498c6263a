// What a query and a miss cost in the batch path, on the batches that the view's picture asks.
//
// Replayed on one thread. A batch is first answered by a cold table, then again until nothing is traced any more: from then on all are
// hits, and keys, hashes and look-ups are all that is left to pay.
#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "base/core/stopwatch.h"
#include "bench/median.h"
#include "bench/visibility_cache/exact_path.h"
#include "bench/visibility_cache/figures.h"
#include "bench/visibility_cache/frame_share.h"
#include "bench/visibility_cache/parts.h"
#include "bench/visibility_cache/query_recorder.h"
#include "visibility/query_rays.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kLookUpRounds = 5;

/// Sums over batches of the medians of some rounds.
struct Replay {
  std::uint64_t queries = 0, lookups = 0, warm_traced = 0;  ///< of warm calls; rays for what the table could not keep
  std::uint64_t cold_misses = 0;
  double warm_seconds = 0, cold_seconds = 0, miss_ray_seconds = 0;
};

/// The times of one batch in each round.
struct BatchTimes {
  std::vector<double> cold, warm, rays;
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

/// As many queries as were missed, from all over the batch.
std::vector<std::uint32_t> spread_out(const QueryBatch& batch, std::uint64_t count) {
  std::vector<std::uint32_t> which;
  which.reserve(count);
  for (std::uint64_t k = 0; k < count; ++k)
    which.push_back(static_cast<std::uint32_t>(std::min<std::uint64_t>(batch.size - 1, k * batch.size / count)));
  return which;
}

Replay replay(const std::vector<RecordedScope>& scopes, const CacheView& view, const std::vector<std::string>& settings,
              const Context& context) {
  const VisibilityInfo& info = find_visibility("cached");
  SettingsValue value = info.settings;
  for (const std::string& setting : settings) value.apply(setting);
  value.apply("importance=0");  // what is a ray whatever the table holds is no look-up
  const std::unique_ptr<Visibility> visibility = info.make(view.world, value, context);
  visibility->begin_pass({0, 0}, context);
  const std::unique_ptr<VisibilityWorker> worker = visibility->worker();
  QueryTracer tracer(*view.world);
  AlignedVector<float> weights;
  Replay sum;
  for (const RecordedScope& scope : scopes) {
    context.check_cancelled();
    std::vector<BatchTimes> times(scope.batches.size());
    for (int round = 0; round < kLookUpRounds; ++round) {
      worker->begin(scope.scope);
      for (std::size_t b = 0; b < scope.batches.size(); ++b) {
        const QueryBatch& batch = scope.batches[b];
        weights.resize(std::max(weights.size(), padded(batch.size) + kLanes));
        RayCounts rays;
        VisibilityCounts cold, settled, warm, traced;
        touch(batch);
        times[b].cold.push_back(timed([&] { worker->visible(batch, weights, rays, cold); }));
        for (int again = 0; again < 8; ++again) {
          const std::uint64_t before = settled.traced;
          worker->visible(batch, weights, rays, settled);
          if (settled.traced == before) break;
        }
        times[b].warm.push_back(timed([&] { worker->visible(batch, weights, rays, warm); }));
        const std::vector<std::uint32_t> some = spread_out(batch, cold.traced);
        times[b].rays.push_back(timed([&] { tracer.trace(batch, some, rays, traced); }));
        if (round > 0) continue;
        sum.queries += batch.size, sum.lookups += warm.lookups, sum.warm_traced += warm.traced, sum.cold_misses += cold.traced;
      }
    }
    for (const BatchTimes& batch : times) {
      const double warm = median(batch.warm);
      sum.warm_seconds += warm, sum.cold_seconds += median(batch.cold) - warm, sum.miss_ray_seconds += median(batch.rays);
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

Json frame_row(const CacheView& view, const std::string& visibility, const std::vector<std::string>& settings, const Context& context) {
  const FrameShare share = measure_frame_share(view, visibility, settings, context);
  const double cores = share.frame_seconds * context.thread_count();
  return {{"visibility", visibility},
          {"settings", settings},
          {"frame_seconds", share.frame_seconds},
          {"visibility_share", cores > 0 ? share.core_seconds / cores : 0},
          {"queries", share.counts.queries},
          {"share_traced", query_figures(share.counts).share_traced},
          {"ns_per_query", per(share.core_seconds, share.counts.queries)}};
}

}  // namespace

Json cache_lookup(const CacheView& view, const CacheBenchOptions& options, const Context& context) {
  context.info(fmt::format("bench visibility-cache: look-ups, {}", view.name));
  const std::uint64_t most = options.quick ? 200'000 : 2'000'000;
  Json json = {{"view", view.name}, {"exact", measure_exact_path(view, most, context)}, {"rows", Json::array()}, {"frames", Json::array()}};
  json["frames"].push_back(frame_row(view, "exact", {}, context));
  for (const int ce : {8, 36}) {
    const std::string edge = fmt::format("ce={}", ce);
    const std::vector<RecordedScope> scopes = record_queries(view, "cached", {edge}, most, context);
    json["rows"].push_back(lookup_row(fmt::format("depth 0, C_E = {}", ce), scopes, view, {edge, "refine=none"}, context));
    json["rows"].push_back(lookup_row(fmt::format("refined, 4 neighbours, C_E = {}", ce), scopes, view, {edge, "refine=4"}, context));
    json["frames"].push_back(frame_row(view, "cached", {edge}, context));
  }
  return json;
}

}  // namespace sightline
