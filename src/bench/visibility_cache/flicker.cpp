// A camera move: how the cache's error changes from frame to frame, and how many frames a second it makes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/median.h"
#include "bench/strip.h"
#include "bench/visibility_cache/figures.h"
#include "bench/visibility_cache/parts.h"
#include "image/false_color.h"
#include "image/metrics/metrics.h"
#include "image/tone_map.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kEdge = 8;
constexpr int kStripFrames = 6;
// Of the scene's half diagonal, a frame: a walk through a hall.
constexpr float kStep = 0.0015f;

Camera moved(Camera camera, float distance) {
  const Mat4& m = camera.world_from_camera;
  const Vec3 right = glm::normalize(Vec3(m[0])), forward = -glm::normalize(Vec3(m[2]));
  const Vec3 step = distance * glm::normalize(forward + 0.3f * right);
  camera.world_from_camera[3] += Vec4(step, 0);
  return camera;
}

/// |difference| in false colours: yellow is half of the frame's mean.
ColorImage false_difference(const ColorImage& cached, const ColorImage& exact) {
  ColorImage difference(exact.width, exact.height);
  double mean = 0;
  for (const Color& c : exact.pixels) mean += static_cast<double>(c.y);
  mean = std::max(1e-9, mean / static_cast<double>(exact.pixels.size()));
  for (std::size_t i = 0; i < exact.pixels.size(); ++i) {
    const Color d = glm::abs(cached.pixels[i] - exact.pixels[i]);
    const Color encoded = false_color(static_cast<float>((d.x + d.y + d.z) / 3 / (0.5 * mean)));
    difference.pixels[i] = {linear_from_srgb(encoded.x), linear_from_srgb(encoded.y), linear_from_srgb(encoded.z)};
  }
  return difference;
}

}  // namespace

Json cache_flicker(CacheView view, const CacheBenchOptions& options, std::optional<ColorImage>& strip, const Context& context) {
  const int frames = options.quick ? 6 : 60;
  view.size_px = options.size_px.value_or(options.quick ? IVec2(160, 120) : IVec2(640, 480));
  context.info(fmt::format("bench visibility-cache: camera move, {}", view.name));
  const Camera start = view.camera;
  const float step = kStep * view.world->bounds().half_diagonal();
  const Metric& linf = find_metric("linf");
  Flicker flicker;
  PictureStrip pictures;
  std::vector<double> exact_seconds, cached_seconds;
  double error = 0, traced = 0;
  for (int frame = 0; frame < frames; ++frame) {
    view.camera = moved(start, step * static_cast<float>(frame));
    const Shot exact = shoot(view, {.visibility = "exact"}, context);
    const Shot cached = shoot(view, {.settings = {fmt::format("ce={}", kEdge)}}, context);
    flicker.add(exact.image, cached.image);
    exact_seconds.push_back(exact.seconds), cached_seconds.push_back(cached.seconds);
    error += linf.compute(exact.image, cached.image, {}) / frames;
    traced += query_figures(cached.statistics.visibility).share_traced / frames;
    if (frame % std::max(1, frames / kStripFrames) == 0) {
      pictures.add({pictures.exposed(cached.image, exact.image), pictures.exposed(exact.image, exact.image),
                    false_difference(cached.image, exact.image)});
    }
  }
  if (!strip) strip = pictures.image();
  return {{"view", view.name},
          {"size", {view.size_px.x, view.size_px.y}},
          {"frames", frames},
          {"ce", kEdge},
          {"flicker", flicker.value()},
          {"linf", error},
          {"share_traced", traced},
          {"exact_frame_seconds", median(exact_seconds)},
          {"cached_frame_seconds", median(cached_seconds)},
          {"exact_frames_per_second", 1 / std::max(1e-9, median(exact_seconds))},
          {"cached_frames_per_second", 1 / std::max(1e-9, median(cached_seconds))}};
}

}  // namespace sightline
