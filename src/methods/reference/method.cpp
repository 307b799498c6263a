#include "methods/reference/method.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "base/parallel/parallel.h"
#include "methods/reference/kernel.h"
#include "methods/reference/settings.h"
#include "methods/tile_loop.h"

namespace sightline {
namespace {

std::uint32_t samples_a_pass(const RenderJob& job) {
  return std::min(static_cast<std::uint32_t>(job.settings.as<ReferenceSettings>().pass_spp), std::max(job.total_spp, 1u));
}

KernelOptions kernel_options(const RenderJob& job, const Context& context) {
  const auto& settings = job.settings.as<ReferenceSettings>();
  KernelOptions options;
  options.light_samples = job.light_samples > 0 ? job.light_samples : settings.light_samples;
  options.max_bounces = job.max_bounces;
  options.roulette_start = settings.roulette_start;
  options.seed = context.seed;
  using Mode = ReferenceSettings::Mode;
  const bool comparison = job.total_spp == 1 && job.light_samples > 0 && job.max_bounces == 0;
  options.one_hit = settings.mode == Mode::one_hit || (settings.mode == Mode::automatic && comparison);
  if (options.one_hit) options.max_bounces = 0;
  if (job.visibility && !job.visibility->exact()) {
    options.visibility = job.visibility;
    options.samples_a_pass = samples_a_pass(job);
  }
  return options;
}

/// Passes of the visibility, cut at absolute multiples of their size: where a pass of the session begins or ends does not matter to them
/// as long as it does so at a multiple.
std::vector<SampleRange> visibility_passes(SampleRange range, std::uint32_t size) {
  std::vector<SampleRange> passes;
  for (std::uint32_t begin = range.begin; begin < range.end;) {
    const std::uint32_t end = std::min(range.end, (begin / size + 1) * size);
    passes.push_back({begin, end});
    begin = end;
  }
  return passes;
}

}  // namespace

const MethodInfo& ReferenceMethod::info() const {
  static const MethodInfo info = [] {
    MethodInfo i;
    i.name = "reference";
    i.help = "path tracing with multiple importance sampling: the truth that other methods are compared with";
    i.citation = "Kajiya1986, Veach1997";
    i.unbiased = i.consistent = i.progressive = i.deterministic = true;
    i.lights = all_light_kinds();
    i.materials = all_material_kinds();
    return i;
  }();
  return info;
}

SettingsValue ReferenceMethod::default_settings() const { return SettingsValue::of<ReferenceSettings>(); }

std::uint32_t ReferenceMethod::pass_multiple(const RenderJob& job) const {
  return job.visibility && !job.visibility->exact() ? samples_a_pass(job) : 1;
}

void ReferenceMethod::render_pass(const RenderJob& job, SampleRange range, Frame& frame, PassStatistics& statistics,
                                  const Context& context) const {
  const KernelOptions options = kernel_options(job, context);
  std::optional<View> centred;
  if (options.one_hit)
    centred.emplace(job.view->camera(), IVec2(job.view->width(), job.view->height()), PixelFilter(PixelFilter::Kind::centre));
  const View& view = centred ? *centred : *job.view;
  // One kernel a thread: its arrays are too large to be made anew for every tile.
  std::vector<std::unique_ptr<PathKernel>> kernels(static_cast<std::size_t>(context.thread_count()));
  const auto render = [&](SampleRange part) {
    for_each_tile(context, frame, part, statistics, [&](const Tile& tile, SampleRange samples, PassStatistics& local) {
      std::unique_ptr<PathKernel>& kernel = kernels[static_cast<std::size_t>(worker_index()) % kernels.size()];
      if (!kernel) kernel = std::make_unique<PathKernel>(*job.world, view, options);
      kernel->render_tile(tile, samples, frame, local);
    });
  };
  if (!options.visibility) {
    render(range);
    return;
  }
  for (const SampleRange& pass : visibility_passes(range, options.samples_a_pass)) {
    job.visibility->begin_pass({pass.begin, 0}, context);
    render(pass);
  }
}

}  // namespace sightline
