#include "session/render.h"

#include <fmt/format.h>

#include "base/core/error.h"
#include "base/simd/simd_target.h"
#include "image/io/image_io.h"

namespace sightline {
namespace {

constexpr double kCheckpointSeconds = 60;

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

void check_memory(const Context& context, const World& world, const Frame& frame) {
  if (context.memory_budget_bytes == 0) return;
  const std::uint64_t needed = frame.memory_bytes() + world.acceleration_bytes() + scene_bytes(world.scene());
  if (needed <= context.memory_budget_bytes) return;
  throw resource_error(fmt::format("the picture needs {:.2f} GiB, the memory limit is {:.2f} GiB", static_cast<double>(needed) / (1u << 30),
                                   static_cast<double>(context.memory_budget_bytes) / (1u << 30)))
      .remedy("raise --memory-limit, or render smaller or with fewer layers");
}

}  // namespace

std::string simd_target_name() { return simd_target(); }

ResolvedSettings resolve_settings(const Method& method, const VisibilityInfo& visibility, const std::vector<std::string>& assignments) {
  ResolvedSettings resolved{method.default_settings(), visibility.settings};
  for (const std::string& assignment : assignments) {
    const std::string key = assignment.substr(0, assignment.find('='));
    if (knows(resolved.method, key))
      resolved.method.apply(assignment);
    else if (knows(resolved.visibility, key))
      resolved.visibility.apply(assignment);
    else
      throw_unknown_setting(key, {&resolved.method.schema(), &resolved.visibility.schema()});
  }
  return resolved;
}

FrameIdentity frame_identity(const World& world, const Camera& camera, IVec2 size_px, const RenderResult& result, std::uint64_t seed) {
  std::string text =
      fmt::format("scene {:016x}; size {}x{}; seed {}; simd {}; method {}; visibility {}; light_samples {}; max_bounces {}; one {}",
                  scene_hash(world.scene()), size_px.x, size_px.y, seed, simd_target_name(), result.method, result.visibility,
                  result.light_samples, result.max_bounces, result.spp == 1);
  for (const auto& [name, value] : result.settings) text += fmt::format("; {}={}", name, value);
  text += "; camera";
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) text += fmt::format(" {}", camera.world_from_camera[column][row]);
  }
  text += fmt::format(" {} {} {} {}", camera.fov_rad, camera.ortho_height, camera.lens_radius, camera.focal_distance);
  return {text};
}

RenderResult render(std::shared_ptr<const World> world, const Camera& camera, IVec2 size_px, PixelFilter filter,
                    const RenderRequest& request, const Context& context, const Stopwatch& since_start, std::vector<FrameSink*> sinks) {
  const Method& method = find_method(request.method);
  const VisibilityInfo& visibility_info = find_visibility(request.visibility.value_or(method.default_visibility()));
  const ResolvedSettings settings = resolve_settings(method, visibility_info, request.settings);
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
  const std::unique_ptr<Visibility> visibility = visibility_info.make(world, settings.visibility);
  job.visibility = visibility.get();
  method.check(world->scene(), job);

  AovSet aovs = request.aovs;
  if (request.target_error) aovs.add(Aov::variance);
  RenderResult result{Frame(size_px.x, size_px.y, aovs, samples.begin),
                      {},
                      StopReason::none,
                      request.method,
                      visibility_info.name,
                      {},
                      spp,
                      job.light_samples,
                      job.max_bounces,
                      std::nullopt,
                      {}};
  result.settings = settings.method.to_text();
  for (auto& setting : settings.visibility.to_text()) result.settings.push_back(std::move(setting));
  const FrameIdentity identity = frame_identity(*world, camera, size_px, result, context.seed);
  if (request.resume) result.frame = resume_frame(*request.resume, identity, samples, aovs);
  check_memory(context, *world, result.frame);

  const Stopwatch prepare_watch;
  const std::unique_ptr<const Bake> bake = method.prepare(job, context);
  job.bake = bake.get();
  result.seconds.prepare = prepare_watch.seconds();

  const ScheduleLimits limits{samples, request.target_error, request.time_limit_s};
  ScheduleState state;
  const Stopwatch render_watch;
  double last_checkpoint = 0;
  const auto checkpoint = [&] {
    if (request.checkpoint) write_file(*request.checkpoint, encode_frame(result.frame, identity, {}));
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
      method.render_pass(job, work.pass, result.frame, result.statistics, context);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::interrupted) throw;
      result.stop = StopReason::interrupted;
      break;
    }
    state.seconds_per_sample = pass_watch.seconds() / work.pass.count();
    for (FrameSink* sink : sinks) sink->pass_done(result.frame, work.pass, samples);
    if (render_watch.seconds() - last_checkpoint > kCheckpointSeconds) checkpoint();
  }
  result.seconds.render = render_watch.seconds();
  checkpoint();
  result.error = result.frame.estimated_error();
  return result;
}

}  // namespace sightline
