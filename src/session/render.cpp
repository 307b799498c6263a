#include "session/render.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "base/core/error.h"
#include "base/simd/simd_target.h"
#include "image/io/image_io.h"
#include "session/memory_needs.h"
#include "session/pass_watch.h"

namespace sightline {
namespace {

constexpr double kCheckpointSeconds = 60;
// After Ctrl-C, a pass may go on for so long.
constexpr double kGraceSeconds = 5;

bool knows(const SettingsValue& value, std::string_view key) {
  for (const Setting& setting : value.schema().settings()) {
    if (setting.name == key) return true;
  }
  return false;
}

Frame resume_frame(const std::filesystem::path& path, const FrameIdentity& identity, SampleRange samples, AovSet aovs) {
  StoredFrame stored = decode_frame(read_file(path), path.string());
  if (stored.identity.text != identity.text)
    throw usage_error("the checkpoint belongs to another picture: scene, view, settings, seed or SIMD target differ").at(path.string());
  if (stored.frame.first_sample() != samples.begin || stored.frame.aovs().bits() != aovs.bits())
    throw usage_error("the checkpoint has another sample range or other layers").at(path.string());
  return std::move(stored.frame);
}

// What two frames must share to be added up or continued.
FrameIdentity frame_identity(const World& world, const View& view, const RenderResult& result, std::uint64_t seed, std::uint32_t multiple) {
  const Camera& camera = view.camera();
  std::string text = fmt::format(
      "scene {:016x}; size {}x{}; filter {}; seed {}; simd {}; method {}; visibility {}; light_samples {}; max_bounces {}; one {}",
      scene_hash(world.scene()), result.frame.width(), result.frame.height(), pixel_filter_name(view.filter().kind()), seed,
      simd_target_name(), result.method, result.visibility, result.light_samples, result.max_bounces, result.spp == 1);
  for (const auto& [name, value] : result.settings) text += fmt::format("; {}={}", name, value);
  if (world.shadow_terminator()) text += "; smooth terminator";
  if (multiple > 1) text += fmt::format("; samples in groups of {}", multiple);
  text += "; camera";
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) text += fmt::format(" {}", camera.world_from_camera[column][row]);
  }
  text += fmt::format(" {} {} {} {}", camera.fov_rad, camera.ortho_height, camera.lens_radius, camera.focal_distance);
  return {text};
}

bool has_samples(const Frame& frame) {
  for (const std::uint32_t count : frame.samples_per_tile()) {
    if (count > 0) return true;
  }
  return false;
}

// Saves progress; a disk that is full must not cost the picture that is being made.
void write_checkpoint(const std::filesystem::path& path, const RenderResult& result, const Context& context) {
  try {
    write_file(path, encode_frame(result.frame, result.identity, {}));
  } catch (const Error& error) {
    context.warn(fmt::format("the checkpoint is not saved: {}", error.what()));
  }
}

}  // namespace

AovSet frame_layers(const RenderRequest& request) {
  AovSet aovs = request.aovs;
  if (request.target_error) aovs.add(Aov::variance);
  return aovs;
}

std::string simd_target_name() { return simd_target(); }

namespace {

/// Whether another visibility has the setting; throws if none of those that have it takes the value.
bool is_of_another_visibility(const std::string& key, const std::string& assignment) {
  std::optional<Error> refused;
  for (const VisibilityInfo& info : visibilities()) {
    if (!knows(info.settings, key)) continue;
    try {
      SettingsValue(info.settings).apply(assignment);
      return true;
    } catch (const Error& error) {
      refused = error;
    }
  }
  if (refused) throw *refused;
  return false;
}

}  // namespace

ResolvedSettings resolve_settings(const Method& method, const VisibilityInfo& visibility, const std::vector<std::string>& assignments) {
  ResolvedSettings resolved{method.default_settings(), visibility.settings, {}};
  for (const std::string& assignment : assignments) {
    const std::string key = assignment.substr(0, assignment.find('='));
    if (knows(resolved.method, key))
      resolved.method.apply(assignment);
    else if (knows(resolved.visibility, key))
      resolved.visibility.apply(assignment);
    else if (is_of_another_visibility(key, assignment)) {
      // Checked all the same: a comparison differs in --visibility alone, and a slip in the rest shows in every run of it.
      resolved.unused.push_back(key);
    } else {
      throw_unknown_setting(key, {&resolved.method.schema(), &resolved.visibility.schema()});
    }
  }
  return resolved;
}

/// Samples that share answers must be rendered together: both ends of the range lie between such groups.
void check_whole_passes(SampleRange samples, std::uint32_t multiple, std::uint32_t spp) {
  if (samples.begin % multiple == 0 && (samples.end % multiple == 0 || samples.end == spp)) return;
  throw usage_error(fmt::format("--sample-range {}:{} cuts through a group of samples that share answers", samples.begin, samples.end))
      .remedy(fmt::format("with these settings both ends must be multiples of {}", multiple));
}

std::uint64_t bake(const std::shared_ptr<const World>& world, const RenderRequest& request, const Context& context) {
  const Method& method = find_method(request.method);
  if (!method.info().needs_bake)
    throw usage_error(fmt::format("method '{}' precomputes nothing", method.info().name)).remedy("'sightline methods' says which ones do");
  const VisibilityInfo& visibility = find_visibility(request.visibility.value_or(method.default_visibility()));
  check_supported(method, world->scene());
  RenderJob job;
  job.world = world;
  job.settings = resolve_settings(method, visibility, request.settings).method;
  job.bakes = request.bakes.get();
  method.check(world->scene(), job);
  const std::unique_ptr<const Bake> bake = method.prepare(job, context);
  return bake ? bake->bytes() : 0;
}

RenderResult render(const std::shared_ptr<const World>& world, const Camera& camera, IVec2 size_px, PixelFilter filter,
                    const RenderRequest& request, const Context& context, const Stopwatch& since_start,
                    const std::vector<FrameSink*>& sinks) {
  const Method& method = find_method(request.method);
  const VisibilityInfo& visibility_info = find_visibility(request.visibility.value_or(method.default_visibility()));
  const ResolvedSettings settings = resolve_settings(method, visibility_info, request.settings);
  if (!settings.unused.empty())
    context.info(fmt::format("visibility '{}' has no setting {}", visibility_info.name, fmt::join(settings.unused, ", ")));
  check_supported(method, world->scene());

  // What neither the user nor the scene decides is the method's.
  const RenderHints& hints = world->scene().hints;
  RenderJob job;
  job.world = world;
  job.settings = settings.method;
  job.max_bounces = request.max_bounces.value_or(hints.max_bounces.value_or(8));
  job.light_samples = request.light_samples.value_or(0);
  const int spp = request.spp.value_or(hints.spp.value_or(method.default_spp()));
  job.total_spp = static_cast<std::uint32_t>(spp);
  const SampleRange samples = request.sample_range.value_or(SampleRange{0, job.total_spp});
  if (samples.end > job.total_spp) throw usage_error(fmt::format("--sample-range ends at {}, but --spp is {}", samples.end, spp));
  const View view(camera, size_px, spp == 1 ? PixelFilter(PixelFilter::Kind::centre) : filter);
  job.view = &view;
  // All of it is known to fit before any of it is allocated. The frame comes first: visibilities that take what is free then see it.
  check_memory(with_world(picture_needs(size_px, request, method.light_image(job), context), *world), context);
  const AovSet aovs = frame_layers(request);
  // Sums are for those who add to a picture later; one sample a pixel that is merely looked at is kept as it is.
  const bool looked_at = spp == 1 && !request.wants_identity && !request.checkpoint && !request.resume && !method.light_image(job);
  Frame frame(size_px.x, size_px.y, aovs, samples.begin, looked_at ? Frame::Colors::single : Frame::Colors::summed);
  const std::unique_ptr<Visibility> visibility = visibility_info.make(world, settings.visibility, context);
  job.visibility = visibility.get();
  method.check(world->scene(), job);
  const std::uint32_t multiple = std::max(1u, method.pass_multiple(job));
  check_whole_passes(samples, multiple, job.total_spp);
  if (!visibility->passes_are_independent() && (request.sample_range || request.resume))
    throw usage_error(
        fmt::format("visibility '{}' learns from pass to pass: parts made apart are not the picture made in one go", visibility_info.name))
        .remedy("render without --sample-range and --resume");

  RenderResult result{std::move(frame),
                      {},
                      StopReason::none,
                      request.method,
                      visibility_info.name,
                      {},
                      spp,
                      job.light_samples,
                      job.max_bounces,
                      std::nullopt,
                      0,
                      {},
                      {}};
  result.settings = settings.method.to_text();
  for (auto& setting : settings.visibility.to_text()) result.settings.push_back(std::move(setting));
  if (request.wants_identity || request.checkpoint || request.resume)
    result.identity = frame_identity(*world, view, result, context.seed, multiple);
  if (request.resume) result.frame = resume_frame(*request.resume, result.identity, samples, aovs);

  const Stopwatch prepare_watch;
  job.bakes = request.bakes.get();
  const std::unique_ptr<const Bake> bake = method.prepare(job, context);
  job.bake = bake.get();
  result.bake_bytes = bake ? bake->bytes() : 0;
  result.seconds.prepare = prepare_watch.seconds();

  const ScheduleLimits limits{samples, request.target_error, request.time_limit_s, multiple};
  ScheduleState state;
  const Stopwatch render_watch;
  std::optional<double> seconds_left;
  if (request.time_limit_s) seconds_left = std::max(0.0, *request.time_limit_s - since_start.seconds());
  const PassWatch watch(context, seconds_left, kGraceSeconds);
  double last_checkpoint = 0;
  const auto checkpoint = [&] {
    if (request.checkpoint) write_checkpoint(*request.checkpoint, result, context);
    last_checkpoint = render_watch.seconds();
  };
  while (true) {
    state.next_sample = samples.begin + result.frame.samples_done();
    state.elapsed_s = since_start.seconds();
    state.interrupted = context.cancelled.load();
    if (request.target_error) state.error = result.frame.estimated_error();
    const ScheduledWork work = schedule(limits, state);
    result.stop = work.stop;
    if (work.stop != StopReason::none) break;
    const Stopwatch pass_watch;
    try {
      method.render_pass(job, work.pass, result.frame, result.statistics, watch.context());
    } catch (const Error& error) {
      if (error.code() != ErrorCode::interrupted) throw;
      result.stop = watch.interrupted() ? StopReason::interrupted : StopReason::time_limit;
      break;
    }
    state.seconds_per_sample = pass_watch.seconds() / work.pass.count();
    for (FrameSink* sink : sinks) sink->pass_done(result.frame, work.pass, samples, result.statistics);
    if (render_watch.seconds() - last_checkpoint > kCheckpointSeconds) checkpoint();
  }
  result.seconds.render = render_watch.seconds();
  if (!has_samples(result.frame)) {
    if (result.stop == StopReason::interrupted) throw Error(ErrorCode::interrupted, "interrupted before any part of the picture was done");
    if (result.stop == StopReason::time_limit)
      throw resource_error(fmt::format("the time limit of {} s passed before any part of the picture was done", *request.time_limit_s))
          .remedy("raise --time-limit");
  }
  checkpoint();
  result.error = result.frame.estimated_error();
  return result;
}

}  // namespace sightline
