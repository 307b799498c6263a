#include "bench/visibility_cache/exact_path.h"
#include "bench/median.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/core/stopwatch.h"
#include "bench/bare_loop.h"
#include "bench/visibility_cache/figures.h"
#include "bench/visibility_cache/query_recorder.h"
#include "trace/embree/embree_tracer.h"
#include "visibility/query_rays.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kRounds = 5;

struct BareCall {
  CallStyle style;
  bool by_light;
};
constexpr std::array<BareCall, 8> kBare = {{{{1, false}, false},
                                            {{8, false}, false},
                                            {{8, true}, false},
                                            {{16, false}, false},
                                            {{16, true}, false},
                                            {{8, true}, true},
                                            {{16, false}, true},
                                            {{16, true}, true}}};
constexpr std::size_t kExact = kBare.size(), kTracer = kExact + 1;

std::string text(const BareCall& call) {
  return fmt::format("{}{}{}", call.style.width,
                     call.style.width == 1 ? ""
                     : call.style.coherent ? " coherent"
                                           : " incoherent",
                     call.by_light ? ", by light" : "");
}

/// The rays of a batch, in the order asked and with those to the same light end side by side.
struct Rays {
  RayBatch asked, by_light;

  void make(const QueryBatch& batch) {
    std::vector<std::uint32_t> order(batch.size);
    std::iota(order.begin(), order.end(), 0u);
    asked.resize(batch.size), by_light.resize(batch.size);
    for (std::size_t i = 0; i < batch.size; ++i) asked.set(i, query_ray(batch, i));
    // Ends that eye points do not share have no neighbours to bring together.
    if (batch.light.size * 4 <= batch.size)
      std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return batch.light_of[a] < batch.light_of[b]; });
    for (std::size_t i = 0; i < batch.size; ++i) by_light.set(i, asked.get(order[i]));
  }
};

}  // namespace

Json measure_exact_path(const CacheView& view, std::uint64_t queries, const Context& context) {
  const std::vector<RecordedScope> scopes = record_queries(view, "exact", {}, queries, context);
  const std::unique_ptr<Visibility> visibility = find_visibility("exact").make(view.world, find_visibility("exact").settings, context);
  const std::unique_ptr<VisibilityWorker> worker = visibility->worker();
  const EmbreeScenes* scenes = embree_scenes(view.world->tracer());
  // Bare calls know neither instances nor alpha masks.
  const bool comparable = scenes && scenes->static_scene && !scenes->top_scene && !(scenes->masks && scenes->masks->any());
  AlignedVector<float> weights;
  AlignedVector<std::uint8_t> blocked;
  Rays made;
  std::uint64_t count = 0;
  std::array<double, kTracer + 1> total{};
  for (const RecordedScope& scope : scopes) {
    context.check_cancelled();
    worker->begin(scope.scope);
    for (const QueryBatch& batch : scope.batches) {
      weights.resize(std::max(weights.size(), padded(batch.size) + kLanes));
      blocked.resize(std::max(blocked.size(), padded(batch.size)));
      RayCounts rays;
      VisibilityCounts counts;
      made.make(batch);
      const auto run = [&](std::size_t candidate) {
        if (candidate == kExact) return worker->visible(batch, weights, rays, counts);
        if (candidate == kTracer) return view.world->tracer().occluded(made.asked, std::span(blocked), batch.kind, rays);
        const BareCall& call = kBare[candidate];
        if (comparable) bare_occluded(scenes->static_scene, call.by_light ? made.by_light : made.asked, blocked.data(), call.style);
      };
      // All by turns; the first round warms up.
      std::array<std::vector<double>, kTracer + 1> seconds;
      for (int round = 0; round <= kRounds; ++round) {
        for (std::size_t c = 0; c < seconds.size(); ++c) {
          const Stopwatch watch;
          run(c);
          if (round > 0) seconds[c].push_back(watch.seconds());
        }
      }
      count += batch.size;
      for (std::size_t c = 0; c < seconds.size(); ++c) total[c] += median(seconds[c]);
    }
  }
  if (count == 0) return {{"rays", 0}};
  const double rate = static_cast<double>(count) * 1e-6;
  Json json = {{"rays", count},
               {"exact_mray_per_s", rate / total[kExact]},
               {"exact_ns_per_query", 1e3 * total[kExact] / rate},
               {"tracer_mray_per_s", rate / total[kTracer]}};
  if (!comparable) return json;
  const auto best = std::min_element(total.begin(), total.begin() + kExact);
  json["bare_mray_per_s"] = rate / *best;
  json["bare_style"] = text(kBare[static_cast<std::size_t>(best - total.begin())]);
  json["throughput_kept"] = *best / total[kExact];
  for (std::size_t c = 0; c < kBare.size(); ++c) json["bare_all"][text(kBare[c])] = rate / total[c];
  return json;
}

}  // namespace sightline
