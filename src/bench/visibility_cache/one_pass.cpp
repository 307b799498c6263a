#include "bench/visibility_cache/one_pass.h"

namespace sightline {
namespace {

const Method& method() { return find_method("visibility-cache"); }

}  // namespace

MadeVisibility make_visibility(const CacheView& view, const std::string& name, const std::vector<std::string>& settings,
                               const Context& context) {
  const VisibilityInfo& info = find_visibility(name);
  const ResolvedSettings resolved = resolve_settings(method(), info, settings);
  return {info.make(view.world, resolved.visibility, context), resolved.method};
}

OnePass render_one_pass(const CacheView& view, const SettingsValue& method_settings, Visibility& visibility, const Context& context) {
  const View camera_view(view.camera, view.size_px, PixelFilter(PixelFilter::Kind::centre));
  Frame frame(view.size_px.x, view.size_px.y, {});
  RenderJob job;
  job.world = view.world;
  job.view = &camera_view;
  job.settings = method_settings;
  job.visibility = &visibility;
  job.max_bounces = view.max_bounces;
  job.light_samples = view.light_samples;
  OnePass pass;
  const Stopwatch watch;
  method().render_pass(job, {0, 1}, frame, pass.statistics, context);
  pass.seconds = watch.seconds();
  return pass;
}

}  // namespace sightline
