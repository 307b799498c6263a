// What pictures that take over what the last one knows save along the path, with the light standing still, and what that costs in error.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "bench/fragments/candidates.h"
#include "bench/fragments/parts.h"
#include "bench/fragments/path.h"
#include "bench/fragments/truth.h"
#include "bench/median.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kWalkFrames = 120, kWalkedFrames = 60, kQuickWalkFrames = 6;
constexpr std::array<const char*, 4> kErrors = {"l2", "nmse", "flip", "psnr"};

/// Frames whose error is looked at, far enough from the first that little is left of it.
std::vector<int> judged_frames(int frames) { return {frames / 3, 2 * frames / 3, frames - 1}; }

struct Walk {
  std::vector<double> seconds;
  double rays = 0;                        ///< shadow rays of all frames
  std::map<std::string, double> counted;  ///< by the method, of all frames
  std::vector<ColorImage> judged;
};

Walk walk_along(BuiltView view, const std::vector<Camera>& cameras, const char* setting, const Context& context) {
  const RenderRequest request = fragments_request({setting});
  const std::vector<int> judged = judged_frames(static_cast<int>(cameras.size()));
  Walk walk;
  for (std::size_t frame = 0; frame < cameras.size(); ++frame) {
    view.camera = cameras[frame];
    Shot shot = shoot(view, request, context);
    walk.seconds.push_back(shot.seconds);
    walk.rays += static_cast<double>(shot.statistics.rays.occlusion);
    for (const auto& [name, count] : shot.statistics.method_statistics) walk.counted[name] += count;
    if (std::ranges::find(judged, static_cast<int>(frame)) != judged.end()) walk.judged.push_back(std::move(shot.image));
  }
  return walk;
}

}  // namespace

Json fragment_temporal(BuiltView view, const FragmentBenchOptions& options, const Context& context) {
  // Half of the path, step by step as long as on the whole.
  const int frames = options.quick ? kQuickWalkFrames : kWalkedFrames;
  view.size_px = options.size_px.value_or(options.quick ? IVec2(160, 120) : IVec2(640, 480));
  context.info(fmt::format("bench fragments: path of the camera alone, {}", view.name));
  std::vector<Camera> cameras;
  cameras.reserve(static_cast<std::size_t>(frames));
  for (int frame = 0; frame < frames; ++frame)
    cameras.push_back(walked(view.camera, court_walk(frame, options.quick ? frames : kWalkFrames), path_scale(view)));

  shoot(view, fragments_request({}), context);
  const std::array<const char*, 2> settings = {"temporal=off", "temporal=on"};
  std::array<Walk, 2> walks;
  for (std::size_t i = 0; i < 2; ++i) walks[i] = walk_along(view, cameras, settings[i], context);

  std::array<Json, 2> errors = {Json::object(), Json::object()};
  const std::vector<int> judged = judged_frames(frames);
  for (std::size_t j = 0; j < judged.size(); ++j) {
    BuiltView there = view;
    there.camera = cameras[static_cast<std::size_t>(judged[j])];
    const FragmentTruth truth = fragment_truth(there, options, context);
    for (std::size_t i = 0; i < 2; ++i) {
      const Json found = fragment_errors(truth, walks[i].judged[j]);
      for (const char* name : kErrors)
        errors[i][name] = errors[i].value(name, 0.0) + found[name].get<double>() / static_cast<double>(judged.size());
    }
  }
  Json rows = Json::array();
  for (std::size_t i = 0; i < 2; ++i) {
    const double frame_seconds = median(walks[i].seconds);
    Json row = {{"name", settings[i]},
                {"rays", walks[i].rays / frames},
                {"median_frame_seconds", frame_seconds},
                {"frames_per_second", 1 / std::max(1e-9, frame_seconds)}};
    for (const auto& [name, count] : walks[i].counted) row["counted"][name] = count / frames;
    row.update(errors[i]);
    rows.push_back(std::move(row));
  }
  return {{"view", view.name},
          {"path", "court walk, light at rest"},
          {"size", {view.size_px.x, view.size_px.y}},
          {"frames", frames},
          {"judged_frames", judged},
          {"rows", std::move(rows)}};
}

}  // namespace sightline
