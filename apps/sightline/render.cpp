// sightline render
#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/core/error.h"
#include "commands.h"
#include "image/io/image_io.h"
#include "session/options_text.h"
#include "session/output.h"
#include "session/statistics.h"
#include "sightline/version.h"

namespace sightline::app {
namespace {

/// Passes the session's progress on to the console.
class ConsoleSink final : public FrameSink {
 public:
  ConsoleSink(Console& console, const Stopwatch& watch) : console_(console), watch_(watch) {}
  void pass_done(const Frame& frame, SampleRange, SampleRange all) override {
    console_.rendered(frame.samples_done(), all.count(), watch_.seconds(), {});
  }

 private:
  Console& console_;
  const Stopwatch& watch_;
};

bool is_slice(const std::string& output) { return std::filesystem::path(output).extension() == ".slice"; }

std::string matrix_text(const Mat4& m) {
  std::string text;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) text += fmt::format("{}{}", text.empty() ? "" : " ", m[column][row]);
  }
  return text;
}

std::vector<std::pair<std::string, std::string>> metadata(const RenderCommand& command, const RenderResult& result, const World& world,
                                                          const Camera& camera, const Context& context, const std::string& statistics) {
  const View view(camera, IVec2(result.frame.width(), result.frame.height()), PixelFilter());
  return {{"sightline.version", kVersion},
          {"sightline.command", command.command_line},
          {"sightline.scene_hash", fmt::format("{:016x}", scene_hash(world.scene()))},
          {"sightline.seed", fmt::format("{}", context.seed)},
          {"sightline.samples", fmt::format("{}", result.frame.samples_done())},
          {"sightline.method", result.method},
          {"sightline.seconds", fmt::format("{:.3f}", result.seconds.render)},
          {"sightline.peak_memory_bytes", fmt::format("{}", peak_resident_bytes())},
          {"sightline.worldToCamera", matrix_text(glm::inverse(camera.world_from_camera))},
          {"sightline.worldToNDC", matrix_text(view.ndc_from_world())},
          {"sightline.statistics", statistics}};
}

void warn_bad_samples(const Frame& frame, const Context& context) {
  const std::optional<BadSample> bad = frame.first_bad_sample();
  if (!bad) return;
  context.warn(fmt::format("{} samples were not finite and left out; the first: pixel {},{} sample {} (replay with --sample-range {}:{})",
                           frame.nonfinite_samples(), bad->pixel % static_cast<std::uint32_t>(frame.width()),
                           bad->pixel / static_cast<std::uint32_t>(frame.width()), bad->sample, bad->sample, bad->sample + 1));
}

/// Renders one animation frame; `previous` (may be null) is the World of the frame before.
StopReason render_frame(const RenderCommand& command, const Scene& loaded, int frame_number, double load_seconds, Console& console,
                        Context& context, std::shared_ptr<const World>& world) {
  const Stopwatch watch;
  Scene scene = pose(loaded, static_cast<float>(frame_number) / command.fps);
  WorldOptions options;
  if (command.tracer == "brute") options.backend = WorldOptions::Backend::brute;
  const Stopwatch build_watch;
  world = world ? World::edit(*world, std::move(scene), context) : World::build(std::move(scene), options, context);
  const double build_seconds = build_watch.seconds();

  const Camera camera = choose_camera(world->scene(), command.view);
  const IVec2 size = choose_size(world->scene(), command.view);
  RenderRequest request = command.render;
  request.aovs = parse_aovs(command.aovs);
  const Stopwatch render_watch;
  ConsoleSink sink(console, render_watch);
  RenderResult result = render(world, camera, size, pixel_filter_from_name(command.view.filter), request, context, watch, {&sink});
  result.seconds.load = load_seconds;
  result.seconds.build = build_seconds;
  console.finish();
  warn_bad_samples(result.frame, context);

  const Stopwatch write_watch;
  OutputOptions output_options;
  output_options.tone_map = tone_map_from_name(command.tonemap);
  output_options.exposure_ev = command.exposure_ev;
  output_options.metadata = metadata(command, result, *world, camera, context, statistics_json(result, *world, context).dump());
  for (const std::string& output : command.outputs) {
    const std::string path = numbered(output, frame_number);
    if (is_slice(path)) {
      const FrameIdentity identity = frame_identity(*world, camera, size, result, context.seed);
      write_file(path, encode_frame(result.frame, identity, statistics_json(result, *world, context).dump()));
    } else {
      write_output(path, result.frame, output_options);
    }
  }
  result.seconds.write = write_watch.seconds();
  result.seconds.total = load_seconds + watch.seconds();
  if (!command.stats.empty()) write_text(numbered(command.stats, frame_number), statistics_json(result, *world, context).dump(2) + "\n");
  const std::uint64_t rays = result.statistics.rays.closest + result.statistics.rays.occlusion;
  context.info(fmt::format("{} x {}, {} of {} spp in {:.2f} s ({:.1f} Mray/s; load {:.2f}, build {:.2f}), stopped by {}", size.x, size.y,
                           result.frame.samples_done(), result.spp, result.seconds.render,
                           static_cast<double>(rays) * 1e-6 / std::max(1e-9, result.seconds.render), load_seconds, build_seconds,
                           name_of(result.stop)));
  return result.stop;
}

}  // namespace

int run_render(const CommandLine& line, Console& console, Context& context) {
  const RenderCommand& command = line.render;
  // Everything that can be refused is refused before the work starts.
  const Method& method = find_method(command.render.method);
  resolve_settings(method, find_visibility(command.render.visibility.value_or(method.default_visibility())), command.render.settings);
  tone_map_from_name(command.tonemap);
  parse_aovs(command.aovs);
  pixel_filter_from_name(command.view.filter);
  FrameRange frames{command.frame.value_or(0), command.frame.value_or(0), 1};
  if (command.frames) frames = parse_frame_range("--frames", *command.frames);
  for (const std::string& output : command.outputs) {
    if (is_slice(output))
      check_writable(output);
    else
      check_output(numbered(output, frames.first));
    if (frames.last > frames.first && !has_number(output))
      throw usage_error(fmt::format("'{}' would be overwritten by each frame", output)).remedy("put #### into the name");
  }
  if (command.memory_limit_gib) context.memory_budget_bytes = static_cast<std::uint64_t>(*command.memory_limit_gib * (1u << 30));
  const std::uint64_t seed = context.seed;

  const Stopwatch load_watch;
  LoadOptions load_options;
  load_options.data_directory = line.common.data_directory;
  Scene scene = load_scenes(command.scenes, load_options, context);
  apply_lights(scene, command.lights, context);
  const double load_seconds = load_watch.seconds();

  std::shared_ptr<const World> world;
  for (int frame = frames.first; frame <= frames.last; frame += frames.step) {
    if (command.skip_existing && std::all_of(command.outputs.begin(), command.outputs.end(),
                                             [&](const std::string& output) { return std::filesystem::exists(numbered(output, frame)); }))
      continue;
    context.seed = command.seed_per_frame ? seed + static_cast<std::uint64_t>(frame) * 0x9e3779b97f4a7c15u : seed;
    if (render_frame(command, scene, frame, load_seconds, console, context, world) == StopReason::interrupted) {
      context.warn("interrupted: the picture holds the samples done so far");
      return kInterrupted;
    }
  }
  return kDone;
}

}  // namespace sightline::app
