// Two objects that shadow each other, frame by frame, beside the reference under the very same light.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "bench/median.h"
#include "bench/square_lights/parts.h"
#include "bench/thumbnail.h"

namespace sightline {

using Json = nlohmann::ordered_json;

namespace {

constexpr int kMovingFrames = 120, kQuickMovingFrames = 12, kEvery = 10, kQuickEvery = 4, kStripFrames = 6;

/// Frames side by side over those of the reference.
class Strip {
 public:
  void add(const ColorImage& frame, const ColorImage& truth) {
    if (columns_.empty()) scale_ = std::exp2(viewing_exposure(truth));
    columns_.push_back({halved(scaled(frame)), halved(scaled(truth))});
  }
  std::optional<ColorImage> image() const {
    if (columns_.empty()) return std::nullopt;
    const int w = columns_[0][0].width, h = columns_[0][0].height;
    ColorImage strip(w * static_cast<int>(columns_.size()), 2 * h);
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      for (int row = 0; row < 2; ++row) {
        for (int y = 0; y < h; ++y)
          std::copy_n(&columns_[c][static_cast<std::size_t>(row)].at(0, y), w, &strip.at(static_cast<int>(c) * w, row * h + y));
      }
    }
    return strip;
  }

 private:
  ColorImage scaled(ColorImage image) const {
    for (Color& c : image.pixels) c *= scale_;
    return image;
  }

  std::vector<std::array<ColorImage, 2>> columns_;
  float scale_ = 1;
};

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
  Strip pictures;
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
    if (frame / every % std::max(1, compared / kStripFrames) == 0) pictures.add(shot.image, truth.image);
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
