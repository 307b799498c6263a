#include "bench/fragments/truth.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <utility>

#include "base/core/error.h"
#include "bench/fragments/candidates.h"
#include "image/io/image_io.h"
#include "image/metrics/metrics.h"

namespace sightline {
namespace {

constexpr int kTruthSamples = 4096, kQuickSamples = 256;
constexpr std::array<const char*, 3> kChannels = {"R", "G", "B"};

std::uint64_t camera_hash(const Camera& camera, std::uint64_t hash) {
  const auto add = [&](float value) { hash = (std::rotl(hash, 5) ^ std::bit_cast<std::uint32_t>(value)) * 0x9e3779b97f4a7c15u; };
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 4; ++r) add(camera.world_from_camera[c][r]);
  }
  add(camera.fov_rad);
  return hash;
}

LayeredImage layered(const ColorImage& image) {
  LayeredImage layers{image.width, image.height, {}, {}};
  for (int c = 0; c < 3; ++c) {
    Channel channel{kChannels[static_cast<std::size_t>(c)], false, {}};
    channel.values.reserve(image.pixels.size());
    for (const Color& color : image.pixels) channel.values.push_back(color[c]);
    layers.channels.push_back(std::move(channel));
  }
  return layers;
}

ColorImage picture(const BuiltView& view, const std::filesystem::path& folder, int samples, const Context& context) {
  const std::filesystem::path file = folder / truth_file_name(view, samples);
  if (!folder.empty() && std::filesystem::exists(file)) {
    ColorImage kept = color_of(read_layered_image(file));
    if (kept.width == view.size_px.x && kept.height == view.size_px.y) return kept;
  }
  if (!folder.empty()) {
    std::filesystem::create_directories(folder);
    check_writable(file);
  }
  context.info(fmt::format("bench fragments: reference, {}, {} samples", view.name, samples));
  ColorImage image = shoot(view, monte_carlo_request(samples), context).image;
  if (!folder.empty()) write_file(file, encode_exr(layered(image)));
  return image;
}

}  // namespace

std::string truth_file_name(const BuiltView& view, int samples) {
  std::string name = view.name;
  for (char& c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (!plain) c = '-';
  }
  // Long names of built-in scenes are told apart by the hash.
  return fmt::format("{}-{}x{}-{}-{:016x}.exr", name.substr(0, 64), view.size_px.x, view.size_px.y, samples,
                     camera_hash(view.camera, scene_hash(view.world->scene())));
}

FragmentTruth fragment_truth(const BuiltView& view, const FragmentBenchOptions& options, const Context& context) {
  FragmentTruth truth;
  truth.samples = options.truth_samples > 0 ? options.truth_samples : options.quick ? kQuickSamples : kTruthSamples;
  truth.image = picture(view, options.cache, truth.samples, context);
  truth.mask = surface_mask(view, monte_carlo_request(1), context);
  return truth;
}

nlohmann::ordered_json fragment_errors(const FragmentTruth& truth, const ColorImage& image) {
  MetricOptions options;
  options.mask = truth.mask;
  nlohmann::ordered_json errors = nlohmann::ordered_json::object();
  for (const char* name : {"l2", "nmse", "flip", "psnr"}) errors[name] = find_metric(name).compute(truth.image, image, options);
  return errors;
}

}  // namespace sightline
