// Frames a second along a path of camera and light. The light is part of the World, which is therefore edited in every frame; that counts.
#include <fmt/format.h>

#include <algorithm>

#include "bench/fragments/candidates.h"
#include "bench/fragments/maps.h"
#include "bench/fragments/parts.h"
#include "bench/fragments/path.h"
#include "bench/median.h"
#include "bench/strip.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFrames = 120, kQuickFrames = 6, kStripFrames = 6;

}  // namespace

Json fragment_interactive(BuiltView view, const FragmentBenchOptions& options, std::optional<ColorImage>& strip, const Context& context) {
  const int frames = options.quick ? kQuickFrames : kFrames;
  view.size_px = options.size_px.value_or(options.quick ? IVec2(160, 120) : IVec2(640, 480));
  context.info(fmt::format("bench fragments: path of camera and light, {}", view.name));
  const float scale = path_scale(view);
  const std::shared_ptr<const World> start = view.world;
  const Camera camera = view.camera;
  const RenderRequest request = fragments_request(fragments_default().settings);
  shoot(view, request, context);

  std::vector<double> seconds, edits;
  double total = 0;
  PictureStrip pictures;
  for (int frame = 0; frame < frames; ++frame) {
    const CourtWalk walk = court_walk(frame, frames);
    const Stopwatch watch;
    view.camera = walked(camera, walk, scale);
    Scene scene = start->scene();
    if (move_lights(scene, walk, scale)) view.world = World::edit(*view.world, std::move(scene), context);
    edits.push_back(watch.seconds());
    const Shot shot = shoot(view, request, context);
    seconds.push_back(watch.seconds());
    total += seconds.back();
    if (options.strip && frame % std::max(1, frames / kStripFrames) == 0) {
      pictures.add({pictures.exposed(shot.image, shot.image), level_map(view, request, context)});
    }
  }
  if (!strip) strip = pictures.image();
  std::vector<double> sorted = seconds;
  std::sort(sorted.begin(), sorted.end());
  return {{"view", view.name},
          {"path", "court walk"},
          {"size", {view.size_px.x, view.size_px.y}},
          {"frames", frames},
          {"frames_per_second", frames / std::max(1e-9, total)},
          {"median_frame_seconds", median(seconds)},
          {"slowest_frame_seconds", sorted.back()},
          {"median_edit_seconds", median(edits)}};
}

}  // namespace sightline
