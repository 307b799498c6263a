#include "bench/trace_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>

#include "base/core/error.h"
#include "base/sample/sobol.h"
#include "base/sample/warp.h"
#include "bench/bare_loop.h"
#include "bench/bench_views.h"
#include "bench/median.h"
#include "session/render.h"
#include "session/stopwatch.h"
#include "sightline/version.h"
#include "trace/embree/embree_tracer.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<CallStyle, 5> kStyles = {{{1, false}, {8, false}, {8, true}, {16, false}, {16, true}}};

std::string text(CallStyle style) {
  return fmt::format("{}{}", style.width, style.width == 1 ? "" : style.coherent ? " coherent" : " incoherent");
}

/// Runs several candidates by turns for some rounds; median seconds of each.
std::vector<double> by_turns(const std::vector<std::function<double()>>& candidates, int rounds) {
  std::vector<std::vector<double>> seconds(candidates.size());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < candidates.size(); ++i) seconds[i].push_back(candidates[i]());
  }
  std::vector<double> medians;
  medians.reserve(seconds.size());
  for (const auto& values : seconds) medians.push_back(median(values));
  return medians;
}

double timed(const std::function<void()>& work) {
  const Stopwatch watch;
  work();
  return watch.seconds();
}

RectangleLight rectangle_of(const Scene& scene, bool& is_geometry, std::uint32_t& instance) {
  for (const Light& light : scene.lights) {
    if (const auto* rectangle = std::get_if<RectangleLight>(&light.shape)) return is_geometry = false, *rectangle;
  }
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Mesh& mesh = scene.meshes[scene.instances[i].mesh.index];
    const MaterialId id = scene.instances[i].material_override.valid() ? scene.instances[i].material_override : mesh.material_of(0);
    if (!id.valid() || is_black(scene.materials[id.index].emission.value) || mesh.positions.size() != 4) continue;
    // Two triangles: the corners 0, 1, 2 of the first span the square.
    const Mat4& m = scene.instances[i].world_from_object;
    const UVec3 t = mesh.triangles[0];
    const Vec3 a = transform_point(m, mesh.positions[t.x]), b = transform_point(m, mesh.positions[t.y]),
               c = transform_point(m, mesh.positions[t.z]);
    RectangleLight light;
    light.center = 0.5f * (a + c), light.half_u = 0.5f * (b - a), light.half_v = 0.5f * (c - b);
    light.radiance = scene.materials[id.index].emission.value;
    is_geometry = true, instance = static_cast<std::uint32_t>(i);
    return light;
  }
  throw usage_error("the view has no rectangle light");
}

/// Rays of the three kinds, in batches as methods make them.
struct RaySets {
  std::vector<RayBatch> primary, shadow, bounce;
};

constexpr std::size_t kBatch = 1024;

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

Json compare_batches(std::string_view name, const std::vector<RayBatch>& batches, RTCScene scene, const Tracer& tracer, BatchKind kind,
                     bool occlusion, int rounds) {
  HitBatch hits;
  AlignedVector<std::uint8_t> blocked(padded(kBatch));
  RayCounts counts;
  std::uint64_t rays = 0;
  for (const RayBatch& batch : batches) rays += batch.size;
  std::vector<std::function<double()>> candidates;
  candidates.push_back([&] {
    return timed([&] {
      for (const RayBatch& batch : batches)
        occlusion ? tracer.occluded(batch, std::span(blocked), kind, counts) : tracer.intersect(batch, hits, kind, counts);
    });
  });
  for (const CallStyle style : kStyles) {
    candidates.push_back([&, style] {
      return timed([&] {
        for (const RayBatch& batch : batches)
          occlusion ? bare_occluded(scene, batch, blocked.data(), style) : bare_intersect(scene, batch, hits, style);
      });
    });
  }
  const std::vector<double> seconds = by_turns(candidates, rounds);
  const auto best = std::min_element(seconds.begin() + 1, seconds.end());
  const double to_rate = static_cast<double>(rays) * 1e-6;
  Json json = {{"rays", name},
               {"tracer_mray_per_s", to_rate / seconds[0]},
               {"bare_mray_per_s", to_rate / *best},
               {"bare_style", text(kStyles[static_cast<std::size_t>(best - seconds.begin() - 1)])},
               {"throughput_kept", *best / seconds[0]}};
  for (std::size_t i = 0; i < kStyles.size(); ++i) json["bare_all"][text(kStyles[i])] = to_rate / seconds[i + 1];
  return json;
}

struct Picture {
  std::string name;
  int spp, light_samples, bounces;
  bool one_hit;
};

Json compare_picture(const Picture& picture, const BareJob& job, std::shared_ptr<const World> world, const Camera& camera, IVec2 size,
                     const Context& context, int rounds) {
  const auto bare = [&](const BareStyle& style, const BareJob& j) {
    return picture.one_hit ? bare_one_hit(j, picture.light_samples, style, context)
                           : bare_paths(j, picture.spp, picture.bounces, style, context);
  };
  // The fastest calls, found kind by kind on a small picture.
  const View small(camera, size / 4, PixelFilter(PixelFilter::Kind::centre));
  BareJob small_job = job;
  small_job.view = &small;
  BareStyle best;
  for (CallStyle BareStyle::* kind : {&BareStyle::primary, &BareStyle::shadow, &BareStyle::bounce}) {
    if (picture.one_hit && kind == &BareStyle::bounce) continue;
    std::vector<std::function<double()>> candidates;
    for (const CallStyle style : kStyles) {
      BareStyle candidate = best;
      candidate.*kind = style;
      candidates.push_back([&, candidate] { return bare(candidate, small_job).seconds; });
    }
    const std::vector<double> seconds = by_turns(candidates, 3);
    best.*kind = kStyles[static_cast<std::size_t>(std::min_element(seconds.begin(), seconds.end()) - seconds.begin())];
  }

  RenderRequest request;
  request.spp = picture.spp, request.max_bounces = picture.bounces;
  request.light_samples = picture.light_samples;
  request.settings = {"roulette_start=1000000", picture.one_hit ? "mode=one-hit" : "mode=path"};
  std::uint64_t product_rays = 0, bare_rays = 0;
  double product_mean = 0, bare_mean = 0;
  const std::vector<double> seconds = by_turns(
      {[&] {
         const RenderResult result = render(world, camera, size, PixelFilter(PixelFilter::Kind::box), request, context, Stopwatch());
         product_rays = result.statistics.rays.closest + result.statistics.rays.occlusion;
         product_mean = result.frame.mean_luminance();
         return result.seconds.render;
       },
       [&] {
         const BareResult result = bare(best, job);
         bare_rays = result.rays;
         bare_mean = result.sum / (static_cast<double>(size.x) * size.y);
         return result.seconds;
       }},
      rounds);
  const double cores = context.thread_count();
  return {{"picture", picture.name},
          {"product_seconds", seconds[0]},
          {"bare_seconds", seconds[1]},
          {"time_ratio", seconds[0] / seconds[1]},
          {"product_mray_per_core_s", static_cast<double>(product_rays) * 1e-6 / seconds[0] / cores},
          {"bare_mray_per_core_s", static_cast<double>(bare_rays) * 1e-6 / seconds[1] / cores},
          {"product_rays", product_rays},
          {"bare_rays", bare_rays},
          {"product_mean", product_mean},
          {"bare_mean", bare_mean},
          {"bare_styles", {{"primary", text(best.primary)}, {"shadow", text(best.shadow)}, {"bounce", text(best.bounce)}}}};
}

Json bench_view(const BenchView& view, const TraceBenchOptions& options, const Context& context) {
  const int rounds = options.quick ? 1 : 3;
  const IVec2 size = options.quick ? view.size_px / 4 : options.size_px.value_or(view.size_px);
  const std::shared_ptr<const World> world = World::build(view.scene, {}, context);
  const EmbreeScenes* scenes = embree_scenes(world->tracer());
  if (!scenes || !scenes->static_scene || scenes->top_scene) throw usage_error("bench trace needs views of static triangles");
  BareJob job;
  job.scene = scenes->static_scene;
  std::uint32_t instance = kNoHit;
  job.light = rectangle_of(world->scene(), job.light_is_geometry, instance);
  const auto& table = scenes->tables.static_instances;
  if (job.light_is_geometry)
    job.light_geometry = static_cast<std::uint32_t>(std::find(table.begin(), table.end(), instance) - table.begin());
  job.epsilon = 1e-4f * world->bounds().half_diagonal();
  const View camera_view(view.camera, size, PixelFilter(PixelFilter::Kind::centre));
  job.view = &camera_view;

  Json json = {{"view", view.name}, {"triangles", instanced_triangle_count(world->scene())}, {"size", {size.x, size.y}}};
  const RaySets rays = make_rays(*world, camera_view, job.light);
  json["tracer"] = {compare_batches("primary", rays.primary, job.scene, world->tracer(), BatchKind::primary, false, rounds),
                    compare_batches("shadow", rays.shadow, job.scene, world->tracer(), BatchKind::shadow, true, rounds),
                    compare_batches("bounce", rays.bounce, job.scene, world->tracer(), BatchKind::bounce, false, rounds)};
  json["pictures"] = Json::array();
  for (const Picture& picture : {Picture{"1 hit + 64 light samples", 1, 64, 0, true},
                                 Picture{"64 samples, 1 light sample, MIS", options.quick ? 8 : 64, 1, 0, false},
                                 Picture{"16 samples, 4 bounces", options.quick ? 2 : 16, 1, 4, false}}) {
    context.info(fmt::format("bench trace: {}, {}", view.name, picture.name));
    json["pictures"].push_back(compare_picture(picture, job, world, view.camera, size, context, options.quick ? 1 : 3));
  }
  return json;
}

}  // namespace

Json run_trace_bench(const TraceBenchOptions& options, const Context& context) {
  Json json = {{"sightline", kVersion},      {"suite", "trace"},       {"threads", context.thread_count()},
               {"simd", simd_target_name()}, {"quick", options.quick}, {"views", Json::array()}};
  for (const std::string& name : options.views) {
    context.check_cancelled();
    const std::optional<BenchView> view = load_bench_view(name, options.data, context);
    if (!view) {
      context.warn(fmt::format("{}: its files are not below the data folder (--data or SIGHTLINE_DATA); left out", name));
      continue;
    }
    json["views"].push_back(bench_view(*view, options, context));
  }
  return json;
}

std::string trace_bench_markdown(const Json& results) {
  std::string text = "| view | rays | Tracer, Mray/s | bare Embree, Mray/s | fastest bare calls | kept |\n|---|---|---:|---:|---|---:|\n";
  for (const Json& view : results["views"]) {
    for (const Json& row : view["tracer"]) {
      text += fmt::format("| {} | {} | {:.1f} | {:.1f} | {} | {:.1f} % |\n", view["view"].get<std::string>(),
                          row["rays"].get<std::string>(), row["tracer_mray_per_s"].get<double>(), row["bare_mray_per_s"].get<double>(),
                          row["bare_style"].get<std::string>(), 100 * row["throughput_kept"].get<double>());
    }
  }
  text +=
      "\n| view | picture | reference, s | bare loop, s | time ratio | reference, Mray/core-s | bare, Mray/core-s "
      "|\n|---|---|---:|---:|---:|---:|---:|\n";
  for (const Json& view : results["views"]) {
    for (const Json& row : view["pictures"]) {
      text += fmt::format("| {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.1f} | {:.1f} |\n", view["view"].get<std::string>(),
                          row["picture"].get<std::string>(), row["product_seconds"].get<double>(), row["bare_seconds"].get<double>(),
                          row["time_ratio"].get<double>(), row["product_mray_per_core_s"].get<double>(),
                          row["bare_mray_per_core_s"].get<double>());
    }
  }
  return text;
}

}  // namespace sightline
