// The Tracer beside bare Embree, on the same batches to the same hits.
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>

#include "base/core/stopwatch.h"
#include "base/sample/sobol.h"
#include "base/sample/warp.h"
#include "bench/median.h"
#include "bench/trace_bench_parts.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kBatch = 1024;
constexpr int kRayRounds = 5, kLongRayRounds = 3;
constexpr double kLongRaySeconds = 3;  // of a round
/// Batches that call styles are ranked by; one batch holds blocks of neighbouring pixels, and those taken lie all over the picture.
constexpr std::size_t kRankingBatches = 160;

/// Rays of the three kinds, in batches as methods make them.
struct RaySets {
  std::vector<RayBatch> primary, shadow, bounce;
};

void push(std::vector<RayBatch>& batches, const Ray& ray) {
  if (batches.empty() || batches.back().size == kBatch) {
    batches.emplace_back();
    batches.back().resize(kBatch);
    batches.back().size = 0;
  }
  const std::size_t at = batches.back().size++;
  batches.back().set(at, ray);
}

RaySets make_rays(const World& world, const View& view, const RectangleLight& light) {
  RaySets sets;
  for (int by = 0; by + 4 <= view.height(); by += 4) {
    for (int bx = 0; bx + 4 <= view.width(); bx += 4) {
      for (int i = 0; i < 16; ++i) {
        const int x = bx + i % 4, y = by + i / 4;
        Ray ray;
        view.ray_through(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, Vec2(0.5f), ray.origin, ray.direction);
        push(sets.primary, ray);
      }
    }
  }
  RayCounts counts;
  std::uint32_t serial = 0;
  for (const RayBatch& batch : sets.primary) {
    HitBatch hits;
    SurfaceBatch s;
    world.tracer().intersect(batch, hits, BatchKind::primary, counts);
    world.surfaces(batch, hits, s);
    for (std::size_t i = 0; i < batch.size; ++i) {
      if (!hits.hit(i)) continue;
      const Vec3 direction{batch.direction.x[i], batch.direction.y[i], batch.direction.z[i]},
          p{s.position.x[i], s.position.y[i], s.position.z[i]};
      Vec3 n{s.geometric_normal.x[i], s.geometric_normal.y[i], s.geometric_normal.z[i]};
      if (glm::dot(n, direction) > 0) n = -n;
      const Vec3 origin = offset_origin(p, n, s.error[i], n);
      const std::uint32_t key = pixel_key(1, serial++);
      // One point in four gets 16 shadow rays: about four times as many as primary rays.
      if (serial % 4 == 0) {
        for (std::uint32_t k = 0; k < 16; ++k) {
          const Vec2 u = 2.f * sobol_2d(key, k, 0) - 1.f;
          const Vec3 target = light.center + u.x * light.half_u + u.y * light.half_v;
          push(sets.shadow, {origin, 0, target - origin, 0.9999f});
        }
      }
      const Vec3 wi = frame_from_normal(n).to_world(sample_cosine_hemisphere(sobol_2d(key, 0, 1)));
      push(sets.bounce, {origin, 0, wi, std::numeric_limits<float>::infinity()});
    }
  }
  return sets;
}

/// Of the calling thread alone: what else the machine does then counts less.
double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Seconds of `trace(batch)` over every `step`-th batch.
template <class Trace>
double timed(const std::vector<RayBatch>& batches, std::size_t step, Trace trace) {
  const double start = thread_seconds();
  for (std::size_t i = 0; i < batches.size(); i += step) trace(batches[i]);
  return thread_seconds() - start;
}

Json compare_batches(std::string_view name, const std::vector<RayBatch>& batches, const TraceStage& stage, BatchKind kind,
                     const TraceBenchOptions& options, const Context& context) {
  const bool occlusion = kind == BatchKind::shadow;
  const Tracer& tracer = stage.world->tracer();
  HitBatch hits;
  AlignedVector<std::uint8_t> blocked(padded(kBatch));
  RayCounts counts;
  const auto bare = [&](CallStyle style, std::size_t step) {
    return timed(batches, step, [&](const RayBatch& batch) {
      occlusion ? bare_occluded(stage.job.scene, batch, blocked.data(), style) : bare_intersect(stage.job.scene, batch, hits, style);
    });
  };
  const auto rays_of = [&](std::size_t step) {
    std::uint64_t rays = 0;
    for (std::size_t i = 0; i < batches.size(); i += step) rays += batches[i].size;
    return static_cast<double>(rays) * 1e-6;
  };
  context.info(fmt::format("bench trace: {}, {} rays: bare call styles", stage.name, name));
  const std::size_t step = std::max<std::size_t>(1, batches.size() / kRankingBatches);
  const StyleRanking ranking = rank_styles([&](CallStyle style) { return bare(style, step); }, options.quick, context);

  // What ranks second in the short runs may be first in the long ones.
  const bool is_long = 3 * static_cast<double>(step) * ranking.seconds[ranking.order.front()] > kLongRaySeconds;
  const int rounds = options.rounds > 0 ? options.rounds : options.quick ? 1 : is_long ? kLongRayRounds : kRayRounds;
  context.info(fmt::format("bench trace: {}, {} rays: Tracer and the two fastest bare styles, {} round{}", stage.name, name, rounds,
                           rounds == 1 ? "" : "s"));
  std::vector<std::function<double()>> candidates;
  candidates.emplace_back([&] {
    return timed(batches, 1, [&](const RayBatch& batch) {
      occlusion ? tracer.occluded(batch, std::span(blocked), kind, counts) : tracer.intersect(batch, hits, kind, counts);
    });
  });
  for (std::size_t i = 0; i < 2; ++i) candidates.emplace_back([&, style = kCallStyles[ranking.order[i]]] { return bare(style, 1); });
  const std::vector<std::vector<double>> seconds = by_turns(candidates, rounds, context);
  const double ours = median(seconds[0]), first = median(seconds[1]), second = median(seconds[2]), theirs = std::min(first, second);
  const double rays = rays_of(1);
  Json json = {{"rays", name},
               {"tracer_mray_per_s", rays / ours},
               {"bare_mray_per_s", rays / theirs},
               {"bare_style", text(kCallStyles[ranking.order[first <= second ? 0 : 1]])},
               {"throughput_kept", theirs / ours},
               {"rounds", rounds}};
  for (std::size_t i = 0; i < kCallStyles.size(); ++i) json["bare_ranking"][text(kCallStyles[i])] = rays_of(step) / ranking.seconds[i];
  return json;
}

}  // namespace

void trace_rays(const TraceStage& stage, const TraceBenchOptions& options, Json& rows, const Context& context) {
  const RaySets rays = make_rays(*stage.world, stage.view, stage.job.light);
  rows.push_back(compare_batches("primary", rays.primary, stage, BatchKind::primary, options, context));
  rows.push_back(compare_batches("shadow", rays.shadow, stage, BatchKind::shadow, options, context));
  rows.push_back(compare_batches("bounce", rays.bounce, stage, BatchKind::bounce, options, context));
}

}  // namespace sightline
