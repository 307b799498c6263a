#include "methods/visibility_cache/method.h"

#include <algorithm>
#include <memory>
#include <vector>

#include "base/parallel/parallel.h"
#include "methods/tile_loop.h"
#include "methods/visibility_cache/kernel.h"

namespace sightline {

const MethodInfo& VisibilityCacheMethod::info() const {
  static const MethodInfo info = [] {
    MethodInfo i;
    i.name = "visibility-cache";
    i.help = "mirrors and glass followed, direct light and instant radiosity, with shadow rays shared by neighbours";
    i.citation = "Popov2013";
    i.progressive = i.deterministic = true;
    i.lights = all_light_kinds();
    i.materials = all_material_kinds();
    return i;
  }();
  return info;
}

SettingsValue VisibilityCacheMethod::default_settings() const { return SettingsValue::of<VisibilityCacheSettings>(); }

std::uint32_t VisibilityCacheMethod::pass_multiple(const RenderJob& job) const {
  const int wanted = job.settings.as<VisibilityCacheSettings>().pass_spp;
  return wanted > 0 ? static_cast<std::uint32_t>(wanted) : std::min<std::uint32_t>(job.total_spp, 16);
}

void VisibilityCacheMethod::render_pass(const RenderJob& job, SampleRange range, Frame& frame, PassStatistics& statistics,
                                        const Context& context) const {
  const auto& settings = job.settings.as<VisibilityCacheSettings>();
  const World& world = *job.world;
  const EyeLights lights(world.lights());
  std::vector<std::unique_ptr<EyeKernel>> kernels(static_cast<std::size_t>(context.thread_count()));
  // Passes of a fixed number of samples share answers and virtual lights, however they are grouped into calls.
  const std::uint32_t multiple = pass_multiple(job);
  for (std::uint32_t begin = range.begin; begin < range.end;) {
    const std::uint32_t index = begin / multiple, first = index * multiple;
    const SampleRange samples{begin, std::min(first + multiple, range.end)};
    EyePass pass;
    pass.samples = std::min(multiple, job.total_spp - std::min(first, job.total_spp - 1));
    pass.light_samples = job.light_samples > 0 ? job.light_samples : settings.light_samples;
    if (settings.vpls > 0 && job.max_bounces > 0) {
      VirtualPointLightOptions options;
      options.count = settings.vpls;
      options.candidates = settings.vpl_candidates;
      options.backward_share = settings.vpl_backward;
      options.clamp_distance = settings.vpl_clamp;
      options.max_bounces = job.max_bounces;
      options.seed = context.seed;
      options.pass = index;
      pass.virtual_lights = make_virtual_point_lights(world, *job.view, options, context, statistics.rays);
      for (std::uint32_t j = 0; j < pass.virtual_lights.size; ++j) {
        if (pass.virtual_lights.lambert[j]) continue;
        pass.general_virtual_lights.push_back(j);
        pass.virtual_lights.bsdf[j].prepare(pass.virtual_lights.frame[j].to_local(pass.virtual_lights.wi[j]));
      }
    }
    statistics.method_statistics["virtual_lights"] += static_cast<double>(pass.virtual_lights.size);
    job.visibility->begin_pass({first, 0}, context);
    for_each_tile(context, frame, samples, statistics, [&](const Tile& tile, SampleRange missing, PassStatistics& local) {
      std::unique_ptr<EyeKernel>& kernel = kernels[static_cast<std::size_t>(worker_index()) % kernels.size()];
      if (!kernel) kernel = std::make_unique<EyeKernel>(world, *job.view, *job.visibility, settings, context, lights);
      kernel->render_tile(tile, missing, pass, frame, local);
    });
    begin = samples.end;
  }
}

}  // namespace sightline
