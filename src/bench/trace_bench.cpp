#include "bench/trace_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "base/core/error.h"
#include "bench/bench_plan.h"
#include "bench/bench_views.h"
#include "bench/trace_bench_parts.h"
#include "session/render.h"
#include "sightline/version.h"
#include "trace/embree/embree_tracer.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

const std::vector<BenchPart>& trace_part_table() {
  static const std::vector<std::string> views = {"sponza-court", "dragon-room", "hairball-room"};
  static const std::vector<BenchPart> table = {{"rays", views}, {"pictures", views}};
  return table;
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

/// Fills in what is done as it goes, so that an interruption leaves it.
void measure(const TraceStage& stage, const BenchPlan& plan, const TraceBenchOptions& options, Json& json, const Context& context) {
  json = {{"view", stage.name},
          {"triangles", instanced_triangle_count(stage.world->scene())},
          {"size", {stage.size_px.x, stage.size_px.y}},
          {"tracer", Json::array()},
          {"pictures", Json::array()}};
  if (plan.has("rays", stage.name)) trace_rays(stage, options, json["tracer"], context);
  if (plan.has("pictures", stage.name)) trace_pictures(stage, options, json["pictures"], context);
}

}  // namespace

TraceStage::TraceStage(std::string view_name, std::shared_ptr<const World> built, const Camera& from, IVec2 size)
    : name(std::move(view_name)),
      world(std::move(built)),
      camera(from),
      size_px(size),
      view(camera, size_px, PixelFilter(PixelFilter::Kind::centre)) {
  const EmbreeScenes* scenes = embree_scenes(world->tracer());
  if (!scenes || !scenes->static_scene || scenes->top_scene) throw usage_error("bench trace needs views of static triangles");
  job.scene = scenes->static_scene;
  std::uint32_t instance = kNoHit;
  job.light = rectangle_of(world->scene(), job.light_is_geometry, instance);
  const auto& table = scenes->tables.static_instances;
  if (job.light_is_geometry)
    job.light_geometry = static_cast<std::uint32_t>(std::find(table.begin(), table.end(), instance) - table.begin());
  job.epsilon = 1e-4f * world->bounds().half_diagonal();
  job.view = &view;
}

std::vector<std::string> trace_bench_parts() { return part_names(trace_part_table()); }

BenchResults run_trace_bench(const TraceBenchOptions& options, const Context& context) {
  const BenchPlan plan(trace_part_table(), options.parts, options.views);
  BenchResults results;
  Json& json = results.json;
  json = {{"sightline", kVersion},      {"suite", "trace"},       {"threads", context.thread_count()},
          {"simd", simd_target_name()}, {"quick", options.quick}, {"interrupted", false},
          {"views", Json::array()}};
  try {
    for (const std::string& name : plan.views()) {
      context.check_cancelled();
      const std::optional<BenchView> view = load_bench_view(name, options.data, context);
      if (!view) {
        context.warn(fmt::format("{}: its files are not below the data folder (--data or SIGHTLINE_DATA); left out", name));
        continue;
      }
      const IVec2 size = options.size_px.value_or(options.quick ? view->size_px / 4 : view->size_px);
      const TraceStage stage(name, World::build(view->scene, {}, context), view->camera, size);
      measure(stage, plan, options, json["views"].emplace_back(), context);
    }
  } catch (const Error& error) {
    // Views that are done are not thrown away.
    if (error.code() != ErrorCode::interrupted) throw;
    json["interrupted"] = true;
  }
  return results;
}

std::string trace_bench_markdown(const Json& results) {
  std::string rays, pictures;
  for (const Json& view : results["views"]) {
    const std::string name = view["view"];
    for (const Json& row : view["tracer"]) {
      rays += fmt::format("| {} | {} | {:.1f} | {:.1f} | {} | {:.1f} % |\n", name, row["rays"].get<std::string>(),
                          row["tracer_mray_per_s"].get<double>(), row["bare_mray_per_s"].get<double>(),
                          row["bare_style"].get<std::string>(), 100 * row["throughput_kept"].get<double>());
    }
    for (const Json& row : view["pictures"]) {
      pictures += fmt::format("| {} | {}x{} | {} | {:.2f} | {:.2f} | {:.2f} | {:.1f} | {:.1f} |\n", name, view["size"][0].get<int>(),
                              view["size"][1].get<int>(), row["picture"].get<std::string>(), row["product_seconds"].get<double>(),
                              row["bare_seconds"].get<double>(), row["time_ratio"].get<double>(),
                              row["product_mray_per_core_s"].get<double>(), row["bare_mray_per_core_s"].get<double>());
    }
  }
  std::string text;
  if (!rays.empty())
    text += "| view | rays | Tracer, Mray/s | bare Embree, Mray/s | fastest bare calls | kept |\n|---|---|---:|---:|---|---:|\n" + rays;
  if (!rays.empty() && !pictures.empty()) text += "\n";
  if (!pictures.empty()) {
    text +=
        "| view | size | picture | reference, s | bare loop, s | time ratio | reference, Mray/core-s | bare, Mray/core-s "
        "|\n|---|---|---|---:|---:|---:|---:|---:|\n" +
        pictures;
  }
  return text;
}

}  // namespace sightline
