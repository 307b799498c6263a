// The public interface of include/sightline/sightline.h, on top of the session.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/core/stopwatch.h"
#include "methods/method.h"
#include "scene/load/load.h"
#include "session/memory_needs.h"
#include "session/render.h"
#include "session/setup.h"
#include "session/statistics.h"
#include "sightline/sightline.h"
#include "visibility/visibility.h"
#include "world/world.h"

namespace sightline {
namespace {

Vec3 to_vec3(const Float3& v) { return {v.x, v.y, v.z}; }

ViewRequest view_request(const RenderOptions& options) {
  ViewRequest view;
  if (!options.camera.empty()) view.camera = options.camera;
  if (options.look_at) {
    view.eye = to_vec3(options.look_at->eye);
    view.target = to_vec3(options.look_at->target);
    view.up = to_vec3(options.look_at->up);
    view.fov_deg = options.look_at->fov_deg;
  }
  if ((options.width > 0) != (options.height > 0) || options.width < 0 || options.height < 0 || options.width > 65536 ||
      options.height > 65536)
    throw usage_error("width and height must both be between 1 and 65536, or both 0");
  if (options.width > 0) view.size_px = IVec2(options.width, options.height);
  return view;
}

RenderRequest render_request(const RenderOptions& options) {
  RenderRequest request;
  request.method = options.method;
  if (!options.visibility.empty()) request.visibility = options.visibility;
  for (const auto& [key, value] : options.settings) request.settings.push_back(fmt::format("{}={}", key, value));
  if (options.spp < 0 || options.light_samples < 0 || options.time_limit_s < 0)
    throw usage_error("spp, light_samples and time_limit_s cannot be negative");
  if (options.spp > 0) request.spp = options.spp;
  if (options.light_samples > 0) request.light_samples = options.light_samples;
  if (options.max_bounces >= 0) request.max_bounces = options.max_bounces;
  if (options.time_limit_s > 0) request.time_limit_s = options.time_limit_s;
  return request;
}

}  // namespace

struct Renderer::Impl {
  RendererOptions options;
  Context context;
  LightRequest lights;
  std::optional<Scene> scene;          ///< as read
  std::shared_ptr<const World> world;  ///< of the scene with lights, at world_time_s
  float world_time_s = 0;
  double load_seconds = 0, build_seconds = 0;
};

Renderer::Renderer(RendererOptions options) : impl_(std::make_unique<Impl>()) {
  impl_->options = std::move(options);
  impl_->context.threads = impl_->options.threads;
  impl_->context.memory_budget_bytes = impl_->options.memory_budget_bytes;
  impl_->lights.default_light = impl_->options.default_light;
  if (impl_->options.log) {
    impl_->context.log = [log = impl_->options.log](LogLevel level, std::string_view text) {
      if (level >= LogLevel::warning) log(std::string(text));
    };
  }
}

Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

void Renderer::load(const std::string& scene) {
  const Stopwatch watch;
  LoadOptions load_options;
  load_options.data_directory = impl_->options.data_directory;
  impl_->scene = load_scene(scene, load_options, impl_->context);
  impl_->world.reset();
  impl_->load_seconds = watch.seconds();
}

void Renderer::add_area_light(const std::string& text) {
  impl_->lights.area.push_back(text);
  impl_->world.reset();
}

void Renderer::add_point_light(const std::string& text) {
  impl_->lights.point.push_back(text);
  impl_->world.reset();
}

void Renderer::add_directional_light(const std::string& text) {
  impl_->lights.directional.push_back(text);
  impl_->world.reset();
}

void Renderer::set_environment(const std::string& file, float scale) {
  impl_->lights.environment = file;
  impl_->lights.environment_scale = scale;
  impl_->world.reset();
}

Picture Renderer::render(const RenderOptions& options) {
  Impl& impl = *impl_;
  if (!impl.scene) throw usage_error("there is no scene").during("rendering").remedy("call load() first");
  const Stopwatch watch;
  impl.context.cancelled = false;
  impl.context.seed = options.seed;
  const ViewRequest view = view_request(options);
  const RenderRequest request = render_request(options);
  if (!impl.world || impl.world_time_s != options.time_s) {
    const Stopwatch build_watch;
    Scene scene = *impl.scene;
    apply_lights(scene, impl.lights, impl.context);
    scene = pose(std::move(scene), options.time_s);
    WorldOptions world_options;
    world_options.tracer.reserved_bytes = picture_needs(choose_size(scene, view), request, false, impl.context).total();
    impl.world =
        impl.world ? World::edit(*impl.world, std::move(scene), impl.context) : World::build(std::move(scene), world_options, impl.context);
    impl.world_time_s = options.time_s;
    impl.build_seconds = build_watch.seconds();
  }
  const Camera camera = choose_camera(impl.world->scene(), view);
  const IVec2 size_px = choose_size(impl.world->scene(), view);
  RenderResult result = sightline::render(impl.world, camera, size_px, PixelFilter(), request, impl.context, watch);
  result.seconds.load = impl.load_seconds;
  result.seconds.build = impl.build_seconds;
  result.seconds.total = impl.load_seconds + watch.seconds();

  Picture picture;
  picture.width = result.frame.width();
  picture.height = result.frame.height();
  const ColorImage colors = result.frame.color_image();
  picture.rgb.reserve(3 * colors.pixels.size());
  for (const Color& color : colors.pixels) picture.rgb.insert(picture.rgb.end(), {color.x, color.y, color.z});
  picture.statistics_json = statistics_json(result, *impl.world, impl.context).dump();
  picture.complete = result.stop != StopReason::interrupted && result.stop != StopReason::time_limit;
  return picture;
}

void Renderer::cancel() noexcept { impl_->context.cancelled = true; }

std::vector<std::string> method_names() {
  std::vector<std::string> names;
  for (const Method* method : methods()) names.push_back(method->info().name);
  return names;
}

std::vector<std::string> visibility_names() {
  std::vector<std::string> names;
  for (const VisibilityInfo& info : visibilities()) names.push_back(info.name);
  return names;
}

}  // namespace sightline
