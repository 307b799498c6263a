#include "methods/example/method.h"

#include "methods/example/bake.h"
#include "methods/example/kernel.h"
#include "methods/example/settings.h"
#include "methods/tile_loop.h"

namespace sightline {

const MethodInfo& ExampleMethod::info() const {
  static const MethodInfo info{
      .name = "example",
      .help = "direct light, one light sample a hit",
      .citation = "",
      .unbiased = true,
      .consistent = true,
      .progressive = true,
      .lights = {LightKind::point, LightKind::spot, LightKind::directional, LightKind::rectangle, LightKind::disk, LightKind::sphere,
                 LightKind::mesh, LightKind::environment},
      .materials = {MaterialKind::diffuse, MaterialKind::metallic_roughness, MaterialKind::coated_diffuse, MaterialKind::phong,
                    MaterialKind::mix},
  };
  return info;
}

SettingsValue ExampleMethod::default_settings() const { return SettingsValue::of<ExampleSettings>(); }

std::unique_ptr<const Bake> ExampleMethod::prepare(const RenderJob& job, const Context& context) const {
  return build_example_bake(*job.world, context);
}

void ExampleMethod::render_pass(const RenderJob& job, SampleRange range, Frame& frame, PassStatistics& statistics,
                                const Context& context) const {
  const auto& settings = job.settings.as<ExampleSettings>();
  job.visibility->begin_pass({range.begin}, context);
  for_each_tile(context, frame, range, statistics, [&](const Tile& tile, SampleRange samples, PassStatistics& local) {
    ExampleKernel kernel(*job.world, *job.view, *job.visibility, settings, context.seed);
    kernel.render_tile(tile, samples, frame, local);
  });
}

}  // namespace sightline
