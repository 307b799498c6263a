#include "methods/fragments/method.h"

#include "base/core/error.h"
#include "methods/fragments/options.h"
#include "methods/fragments/picture.h"
#include "methods/fragments/settings.h"

namespace sightline {

const MethodInfo& FragmentsMethod::info() const {
  static const MethodInfo info = [] {
    MethodInfo i;
    i.name = "fragments";
    i.help = "direct light of area lights: shadow rays for squares of pixels, fine ones only where the shadow needs them";
    i.citation = "Koa2017";
    i.progressive = i.deterministic = true;
    i.lights = {LightKind::rectangle, LightKind::disk, LightKind::mesh};
    i.materials = all_material_kinds();
    // What only bounds a medium would have to be passed by camera rays, and what lies behind it would be dimmed.
    std::erase(i.materials, MaterialKind::interface_only);
    return i;
  }();
  return info;
}

SettingsValue FragmentsMethod::default_settings() const { return SettingsValue::of<FragmentsSettings>(); }

void FragmentsMethod::check(const Scene&, const RenderJob& job) const {
  using S = FragmentsSettings;
  const S& settings = job.settings.as<S>();
  if (settings.refine == S::Refine::all && settings.show != S::Show::picture)
    throw usage_error("refine=all has no stages to show").remedy("leave out refine=all, or show=");
  if (settings.temporal) {
    const FragmentOptions options = resolve(settings);
    if (options.refine != FragmentOptions::Refine::probes || !options.ratio)
      throw usage_error("temporal=on keeps shares of lights that probes have seen")
          .remedy("use refine=koa and signal=ratio, or temporal=off");
    if (job.total_spp != 1)
      throw usage_error("temporal=on takes one picture after the other, of one sample a pixel each").remedy("use --spp 1, or temporal=off");
    if (job.visibility && !job.visibility->exact())
      throw usage_error("temporal=on saves rays, and there are none to save here").remedy("use --visibility exact, or temporal=off");
  }
  if (job.visibility && !job.visibility->binary())
    throw usage_error("method fragments compares which rays arrive: it needs answers of yes or no")
        .remedy("use --visibility exact or cached");
}

void FragmentsMethod::render_pass(const RenderJob& job, SampleRange range, Frame& frame, PassStatistics& statistics,
                                  const Context& context) const {
  FragmentPicture picture(job, *job.view, job.settings.as<FragmentsSettings>(), context,
                          buffers_.take(job.view->width(), job.view->height()));
  picture.expect(range.count());
  for (std::uint32_t sample = range.begin; sample < range.end; ++sample) {
    // Whole pictures: tiles are done together.
    bool missing = false;
    for (std::size_t tile = 0; tile < frame.tile_count(); ++tile) missing |= frame.first_sample() + frame.samples_done(tile) <= sample;
    if (!missing) continue;
    job.visibility->begin_pass({sample, 0}, context);
    picture.render(sample, frame, statistics);
  }
  buffers_.give(picture.release());
}

}  // namespace sightline
