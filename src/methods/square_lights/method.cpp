#include "methods/square_lights/method.h"

#include <algorithm>
#include <chrono>

#include "base/core/error.h"
#include "base/parallel/parallel.h"
#include "methods/square_lights/frame_shading.h"
#include "methods/square_lights/kernel.h"
#include "methods/square_lights/square_bake.h"
#include "methods/tile_loop.h"

namespace sightline {

using namespace square_lights;

namespace {

// Vertices that one task shades.
constexpr std::size_t kGrain = 256;
// How many vertices ahead memory is asked for tables: one takes some hundred nanoseconds.
constexpr std::size_t kAhead = 2;

}  // namespace

const MethodInfo& SquareLightsMethod::info() const {
  static const MethodInfo info = [] {
    MethodInfo i;
    i.name = "square-lights";
    i.help = "environments as a few squares, visibility by precomputed distances: moving objects, live materials";
    i.citation = "Xu2006";
    i.progressive = i.deterministic = i.needs_bake = true;
    i.lights = {LightKind::rectangle, LightKind::disk, LightKind::sphere, LightKind::mesh, LightKind::environment};
    i.materials = all_material_kinds();
    // What has no table: light that passes, and choices between tables.
    std::erase_if(i.materials, [](MaterialKind kind) {
      return kind == MaterialKind::dielectric || kind == MaterialKind::diffuse_transmission || kind == MaterialKind::mix ||
             kind == MaterialKind::interface_only;
    });
    return i;
  }();
  return info;
}

SettingsValue SquareLightsMethod::default_settings() const { return SettingsValue::of<SquareLightsSettings>(); }

void SquareLightsMethod::check(const Scene&, const RenderJob& job) const {
  const auto& settings = job.settings.as<SquareLightsSettings>();
  parse_lights(settings.lights);
  if (settings.rays % 32 != 0 || settings.occluder_rays % 32 != 0)
    throw usage_error("square-lights: rays and occluder_rays are multiples of 32, the size of a table");
  if (settings.basis == SquareLightsSettings::Basis::haar && (settings.cube & (settings.cube - 1)) != 0)
    throw usage_error("square-lights: basis=haar needs a cube whose size is a power of two");
}

std::unique_ptr<const Bake> SquareLightsMethod::prepare(const RenderJob& job, const Context& context) const {
  BakeStore nowhere;
  return std::make_unique<SquareBake>(*job.world, job.settings.as<SquareLightsSettings>(), job.bakes ? *job.bakes : nowhere, context);
}

void SquareLightsMethod::render_pass(const RenderJob& job, SampleRange range, Frame& frame, PassStatistics& statistics,
                                     const Context& context) const {
  const auto& settings = job.settings.as<SquareLightsSettings>();
  const auto& bake = static_cast<const SquareBake&>(*job.bake);
  const FrameShading shading(bake, settings, *job.view);
  const auto threads = static_cast<std::size_t>(context.thread_count());
  ShadingCounts counts;
  AlignedVector<float> radiance;
  const auto start = std::chrono::steady_clock::now();
  // Colours of wavelets and traced texels exist at vertices alone.
  const bool traced = !bake.texel_masks().empty();
  if (settings.shading == SquareLightsSettings::Shading::vertex || traced) {
    const std::size_t vertices = bake.scene().vertices().size();
    radiance.resize(std::max<std::size_t>(4 * vertices, 4));
    std::vector<FrameShading::Scratch> scratch(threads);
    parallel_for(context, vertices, kGrain, [&](std::size_t begin, std::size_t end) {
      FrameShading::Scratch& own = scratch[static_cast<std::size_t>(worker_index())];
      for (std::size_t i = begin; i < end; ++i) {
        const std::uint32_t vertex = bake.scene().order()[i];
        if (i + kAhead < end) shading.prefetch_vertex(bake.scene().order()[i + kAhead]);
        const Color color = shading.shade_vertex(vertex, own);
        for (int c = 0; c < 3; ++c) radiance[4 * std::size_t{vertex} + static_cast<std::size_t>(c)] = color[c];
      }
    });
    for (const FrameShading::Scratch& s : scratch) counts += s.counts;
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  statistics.stage_seconds["vertices"] += seconds * static_cast<double>(threads);

  std::vector<std::unique_ptr<SquareKernel>> kernels(threads);
  for_each_tile(context, frame, range, statistics, [&](const Tile& tile, SampleRange samples, PassStatistics& local) {
    std::unique_ptr<SquareKernel>& kernel = kernels[static_cast<std::size_t>(worker_index())];
    if (!kernel) kernel = std::make_unique<SquareKernel>(*job.world, *job.view, bake, shading, radiance, context.seed);
    kernel->render_tile(tile, samples, frame, local);
  });
  for (const std::unique_ptr<SquareKernel>& kernel : kernels) {
    if (kernel) counts += kernel->counts();
  }
  auto& named = statistics.method_statistics;
  named["vertices"] = static_cast<double>(bake.scene().vertices().size());
  named["square_lights"] = static_cast<double>(shading.light_count());
  named["occluders"] = static_cast<double>(bake.occluders().size() + bake.planes().size());
  named["receivers_shaded"] += static_cast<double>(counts.receivers);
  named["lights_shaded"] += static_cast<double>(counts.lights);
  named["occluder_tests"] += static_cast<double>(counts.occluder_tests);
  named["bake_rays"] = static_cast<double>(bake.rays().occlusion + bake.rays().closest);
}

}  // namespace sightline
