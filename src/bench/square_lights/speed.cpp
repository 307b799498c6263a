// Table 1: frames in which light, camera and objects move. Everything that a frame needs is done in it: the edit of the scene, what the
// method prepares, the light of every vertex, camera rays, interpolation.
#include <fmt/format.h>

#include <algorithm>

#include "bench/median.h"
#include "bench/square_lights/motion.h"
#include "bench/square_lights/parts.h"

namespace sightline {

using Json = nlohmann::ordered_json;

namespace {

constexpr int kFrames = 60, kQuickFrames = 5;
constexpr double kFrameRate = 24;

}  // namespace

Json square_speed(SquareStage stage, const SquareBenchShared& shared, const Context& context) {
  const int frames = shared.options.quick ? kQuickFrames : kFrames;
  context.info(fmt::format("bench square-lights: {} frames, {}", frames, stage.name));
  const int parts = moving_part_count(stage.scene);
  if (parts == 0) remove_ground(stage.scene);
  set_content_material(stage.scene, glossy_material());
  const Vec3 center = (stage.scene.framing ? *stage.scene.framing : scene_bounds(stage.scene)).center();
  const Camera camera = stage.camera;
  const RenderRequest request = square_request(shared.options, shared.bakes, {"lights=30"});
  BuiltView view = build_stage(stage, 0, context);
  // Bakes are made here, not in the first frame.
  shoot(view, request, context);

  std::vector<double> whole, edits, prepares, passes, vertices;
  double sum = 0;
  PassStatistics counted;
  for (int frame = 0; frame < frames; ++frame) {
    const Stopwatch watch;
    turn_light(stage.scene, turned_about(Vec3(0.2f, 1, 0.1f), glm::radians(kLightStepDeg)));
    edit_stage(view, stage, static_cast<float>((frame + 1) / kFrameRate), context);
    edits.push_back(watch.seconds());
    view.camera = orbited(camera, center, glm::radians(kCameraStepDeg * static_cast<float>(frame + 1)));
    const Shot shot = shoot(view, request, context);
    whole.push_back(watch.seconds());
    sum += whole.back();
    prepares.push_back(shot.prepare_seconds), passes.push_back(shot.seconds);
    const auto stage_seconds = shot.statistics.stage_seconds.find("vertices");
    if (stage_seconds != shot.statistics.stage_seconds.end()) vertices.push_back(stage_seconds->second / context.thread_count());
    counted += shot.statistics;
  }
  const auto statistic = [&](const char* name) {
    const auto found = counted.method_statistics.find(name);
    return found != counted.method_statistics.end() ? Json(found->second / frames) : Json();
  };
  return {{"view", stage.name},
          {"size", {view.size_px.x, view.size_px.y}},
          {"vertices", vertex_count(stage.scene)},
          {"parts", parts},
          {"lights", 30},
          {"frames", frames},
          {"frames_per_second", frames / std::max(1e-9, sum)},
          {"median_frame_seconds", median(whole)},
          {"slowest_frame_seconds", *std::max_element(whole.begin(), whole.end())},
          {"edit_seconds", median(edits)},
          {"prepare_seconds", median(prepares)},
          {"pass_seconds", median(passes)},
          {"shading_seconds", vertices.empty() ? Json() : Json(median(vertices))},
          {"shading_frames_per_second", vertices.empty() ? Json() : Json(1 / std::max(1e-9, median(vertices)))},
          {"lights_shaded", statistic("lights_shaded")},
          {"occluder_tests", statistic("occluder_tests")},
          {"occlusion_rays", counted.rays.occlusion}};
}

}  // namespace sightline
