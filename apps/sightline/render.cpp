// sightline render
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/core/error.h"
#include "commands.h"
#include "image/io/image_io.h"
#include "session/material_option.h"
#include "session/memory_needs.h"
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
  void pass_done(const Frame& frame, SampleRange, SampleRange all, const PassStatistics& statistics) override {
    console_.rendered(frame.samples_done(), all.count(), watch_.seconds(), statistics.rays);
  }

 private:
  Console& console_;
  const Stopwatch& watch_;
};

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

/// Writes what a user asked for, each output on its own: one that cannot be written does not cost the others. Throws the first failure.
void write_outputs(const RenderCommand& command, int frame_number, const RenderResult& result, const World& world, const Camera& camera,
                   const Context& context) {
  const std::string statistics = statistics_json(result, world, context).dump();
  OutputOptions options;
  options.tone_map = tone_map_from_name(command.tonemap);
  options.exposure_ev = command.exposure_ev;
  options.metadata = metadata(command, result, world, camera, context, statistics);
  options.identity = result.identity;
  options.note = statistics;
  std::optional<Error> failure;
  for (const std::string& output : command.outputs) {
    try {
      write_output(numbered(output, frame_number), result.frame, options);
    } catch (const Error& error) {
      if (failure)
        context.say(LogLevel::error, error.what());
      else
        failure = error;
    }
  }
  if (failure) throw *failure;
}

/// What stays the same for all frames of a run.
struct Sequence {
  const RenderCommand& command;
  const Scene& loaded;
  double load_seconds;
  bool one_frame;  ///< else an interrupted frame is not written, so that --skip-existing goes on there
  Console& console;
  Context& context;
  std::shared_ptr<BakeStore> bakes;  ///< of all frames
};

RenderRequest frame_request(const RenderCommand& command, int frame_number, bool one_frame) {
  RenderRequest request = command.render;
  request.aovs = parse_aovs(command.aovs);
  if (request.checkpoint) request.checkpoint = numbered(request.checkpoint->string(), frame_number);
  if (request.resume) request.resume = numbered(request.resume->string(), frame_number);
  // Of a sequence, the frames that an earlier run did not come to have no checkpoint.
  if (!one_frame && request.resume && !std::filesystem::exists(*request.resume)) request.resume.reset();
  return request;
}

/// Renders one animation frame; `world` (null at first) is the World of the frame before. `watch` counts towards the time limit.
StopReason render_frame(const Sequence& sequence, int frame_number, const Stopwatch& watch, std::shared_ptr<const World>& world) {
  const RenderCommand& command = sequence.command;
  Context& context = sequence.context;
  const Stopwatch build_watch;
  Scene scene = pose(sequence.loaded, static_cast<float>(frame_number) / command.fps);
  turn_environment(scene, command.lights.environment_turn_deg * static_cast<float>(frame_number));
  WorldOptions options;
  if (command.tracer == "brute") options.backend = WorldOptions::Backend::brute;
  options.shadow_terminator = command.smooth_terminator;
  const IVec2 size = choose_size(scene, command.view);
  RenderRequest request = frame_request(command, frame_number, sequence.one_frame);
  request.bakes = sequence.bakes;
  options.tracer.reserved_bytes = picture_needs(size, request, false, context).total();
  world = world ? World::edit(*world, std::move(scene), context) : World::build(std::move(scene), options, context);
  const double build_seconds = build_watch.seconds();

  const Camera camera = choose_camera(world->scene(), command.view);
  const Stopwatch render_watch;
  ConsoleSink sink(sequence.console, render_watch);
  RenderResult result = render(world, camera, size, pixel_filter_from_name(command.view.filter), request, context, watch, {&sink});
  result.seconds.load = sequence.load_seconds;
  result.seconds.build = build_seconds;
  sequence.console.finish();
  warn_bad_samples(result.frame, context);
  if (result.frame.samples_done() == 0) context.warn("not every part of the picture has a sample: it was ended within its first pass");
  if (result.stop == StopReason::interrupted && (!sequence.one_frame || command.skip_existing)) return result.stop;

  const Stopwatch write_watch;
  result.seconds.total = watch.seconds();
  std::optional<Error> failure;
  try {
    write_outputs(command, frame_number, result, *world, camera, context);
  } catch (const Error& error) {
    failure = error;
  }
  result.seconds.write = write_watch.seconds();
  result.seconds.total = watch.seconds();
  if (!command.stats.empty()) write_text(numbered(command.stats, frame_number), statistics_json(result, *world, context).dump(2) + "\n");
  if (failure) throw *failure;
  const std::uint64_t rays = result.statistics.rays.closest + result.statistics.rays.occlusion;
  context.info(fmt::format("{} x {}, {} of {} spp in {:.2f} s ({:.1f} Mray/s; load {:.2f}, build {:.2f}), stopped by {}", size.x, size.y,
                           result.frame.samples_done(), result.spp, result.seconds.render,
                           static_cast<double>(rays) * 1e-6 / std::max(1e-9, result.seconds.render), sequence.load_seconds, build_seconds,
                           name_of(result.stop)));
  return result.stop;
}

/// Everything that can be refused is refused before the work starts.
void check_command(const RenderCommand& command, const FrameRange& frames, const Context& context) {
  const Method& method = find_method(command.render.method);
  resolve_settings(method, find_visibility(command.render.visibility.value_or(method.default_visibility())), command.render.settings);
  tone_map_from_name(command.tonemap);
  pixel_filter_from_name(command.view.filter);
  RenderRequest request = command.render;
  request.aovs = parse_aovs(command.aovs);
  if (command.view.size_px) check_memory(picture_needs(choose_size({}, command.view), request, false, context), context);

  std::vector<std::string> files = command.outputs;
  for (const std::string& output : command.outputs) check_output(numbered(output, frames.first));
  if (!command.stats.empty()) files.push_back(command.stats);
  if (request.checkpoint) files.push_back(request.checkpoint->string());
  int on_stdout = 0;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const bool is_stdout = files[i] == "-" || files[i].ends_with(":-");
    on_stdout += is_stdout ? 1 : 0;
    if (is_stdout) continue;
    if (i >= command.outputs.size()) check_writable(numbered(files[i], frames.first));
    if (frames.last > frames.first && !has_number(files[i]))
      throw usage_error(fmt::format("'{}' would be overwritten by each frame", files[i])).remedy("put #### into the name");
    if (std::count(files.begin(), files.end(), files[i]) > 1) throw usage_error(fmt::format("'{}' is given twice as an output", files[i]));
  }
  if (on_stdout > 1) throw usage_error("only one output can go to standard output");
  if (request.resume && frames.last > frames.first && !has_number(request.resume->string()))
    throw usage_error("--resume of a sequence needs #### in the name");
}

}  // namespace

int run_render(const CommandLine& line, Console& console, Context& context) {
  const Stopwatch start;
  const RenderCommand& command = line.render;
  FrameRange frames{command.frame.value_or(0), command.frame.value_or(0), 1};
  if (command.frames) frames = parse_frame_range("--frames", *command.frames);
  if (command.memory_limit_gib)
    context.memory_budget_bytes = static_cast<std::uint64_t>(std::min(*command.memory_limit_gib, 1e9) * (1u << 30));
  check_command(command, frames, context);
  const std::uint64_t seed = context.seed;

  LoadOptions load_options;
  load_options.data_directory = line.common.data_directory;
  const std::vector<MaterialRequest> materials = parse_materials(command.materials, load_options.data_directory);
  Scene scene = load_scenes(command.scenes, load_options, context);
  apply_materials(scene, materials);
  apply_lights(scene, command.lights, context);
  const Sequence sequence{command, scene, start.seconds(), frames.first == frames.last, console, context, open_bakes(command)};

  std::shared_ptr<const World> world;
  bool first = true;
  for (std::int64_t number = frames.first; number <= frames.last; number += frames.step) {
    const int frame = static_cast<int>(number);
    if (command.skip_existing && std::all_of(command.outputs.begin(), command.outputs.end(),
                                             [&](const std::string& output) { return std::filesystem::exists(numbered(output, frame)); }))
      continue;
    context.check_cancelled();
    context.seed = command.seed_per_frame ? seed + static_cast<std::uint64_t>(frame) * 0x9e3779b97f4a7c15u : seed;
    // The first frame waits for the scene, so loading counts towards its time limit.
    const Stopwatch own;
    const StopReason stop = render_frame(sequence, frame, first ? start : own, world);
    first = false;
    if (stop != StopReason::interrupted) continue;
    if (sequence.one_frame && !command.skip_existing)
      context.warn("interrupted: the picture holds the samples done so far");
    else
      context.warn(fmt::format("interrupted: frame {} is not written, since it would pass for a complete one", frame));
    return kInterrupted;
  }
  return kDone;
}

}  // namespace sightline::app
