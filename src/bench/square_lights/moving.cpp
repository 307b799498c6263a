// Two objects that shadow each other, frame by frame, beside the reference under the very same light.
#include <fmt/format.h>

#include <algorithm>

#include "bench/median.h"
#include "bench/square_lights/parts.h"
#include "bench/strip.h"

namespace sightline {

using Json = nlohmann::ordered_json;

namespace {

constexpr int kMovingFrames = 120, kQuickMovingFrames = 12, kEvery = 10, kQuickEvery = 4, kStripFrames = 6;

}  // namespace

Json square_moving(SquareStage stage, const SquareBenchShared& shared, std::optional<ColorImage>& strip, const Context& context) {
  const bool quick = shared.options.quick;
  const int frames = quick ? kQuickMovingFrames : kMovingFrames, every = quick ? kQuickEvery : kEvery;
  const float duration = stage.scene.animation_duration_s;
  if (!(duration > 0)) {
    context.warn(fmt::format("{}: nothing moves; not measured", stage.name));
    return {};
  }
  context.info(fmt::format("bench square-lights: {} frames against the reference, {}", frames, stage.name));
  light_by_cube(stage.scene, shared.options, context);
  const RenderRequest request = square_request(shared.options, shared.bakes, {});
  const RenderRequest truth_request = light_request(truth_samples(shared.options));
  BuiltView view = build_stage(stage, 0, context);
  shoot(view, request, context);

  Json rows = Json::array();
  std::vector<double> seconds, flips;
  std::uint64_t rays = 0;
  PictureStrip pictures;  // over those of the reference
  const int compared = (frames + every - 1) / every;
  for (int frame = 0; frame < frames; ++frame) {
    const Stopwatch watch;
    edit_stage(view, stage, duration * static_cast<float>(frame) / static_cast<float>(frames), context);
    const Shot shot = shoot(view, request, context);
    seconds.push_back(watch.seconds());
    rays += shot.statistics.rays.occlusion;
    if (frame % every != 0) continue;
    const Shot truth = shoot(view, truth_request, context);
    Json row = {{"frame", frame}};
    row.update(square_differences(truth.image, shot.image, surface_mask(view, light_request(1), context)));
    flips.push_back(row["flip"].get<double>());
    rows.push_back(std::move(row));
    if (frame / every % std::max(1, compared / kStripFrames) == 0)
      pictures.add({pictures.exposed(shot.image, truth.image), pictures.exposed(truth.image, truth.image)});
  }
  if (!strip) strip = pictures.image();
  return {{"view", stage.name},
          {"size", {view.size_px.x, view.size_px.y}},
          {"vertices", vertex_count(stage.scene)},
          {"frames", frames},
          {"truth_samples", truth_samples(shared.options)},
          {"worst_flip", *std::max_element(flips.begin(), flips.end())},
          {"median_flip", median(flips)},
          {"median_frame_seconds", median(seconds)},
          {"occlusion_rays", rays},
          {"rows", std::move(rows)}};
}

}  // namespace sightline
