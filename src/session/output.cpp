#include "session/output.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/core/error.h"
#include "image/io/image_io.h"

namespace sightline {
namespace {

struct Target {
  std::string format;
  std::filesystem::path path;
};

constexpr std::array<std::string_view, 7> kFormats = {"exr", "hdr", "pfm", "png", "jpg", "jpeg", "slice"};

Target target_of(const std::string& output) {
  Target target;
  const std::size_t colon = output.find(':');
  if (colon != std::string::npos && output.substr(colon + 1) == "-") {
    target.format = output.substr(0, colon);
    target.path = "-";
  } else {
    target.path = output;
    target.format = target.path.extension().string();
    if (!target.format.empty()) target.format.erase(0, 1);
    std::transform(target.format.begin(), target.format.end(), target.format.begin(), [](unsigned char c) { return std::tolower(c); });
  }
  if (std::find(kFormats.begin(), kFormats.end(), target.format) == kFormats.end())
    throw usage_error(fmt::format("cannot write '{}': unknown ending", output)).remedy(fmt::format("known: {}", fmt::join(kFormats, ", ")));
  return target;
}

// PNG's colour is not premultiplied: it is the mean over the covered part alone. Where nothing is covered the background's stays, for
// viewers that ignore alpha.
std::vector<std::uint8_t> straight_rgba8(const Frame& frame, const OutputOptions& options) {
  ColorImage image = frame.color_image();
  std::vector<float> alpha(image.pixels.size());
  for (std::uint32_t pixel = 0; pixel < alpha.size(); ++pixel) {
    alpha[pixel] = frame.value(Aov::alpha, pixel).x;
    if (alpha[pixel] > 0) image.pixels[pixel] /= alpha[pixel];
  }
  const std::vector<std::uint8_t> rgb = to_srgb8(image, options.tone_map, options.exposure_ev);
  std::vector<std::uint8_t> rgba;
  rgba.reserve(4 * alpha.size());
  for (std::size_t pixel = 0; pixel < alpha.size(); ++pixel) {
    rgba.insert(rgba.end(), {rgb[3 * pixel], rgb[3 * pixel + 1], rgb[3 * pixel + 2]});
    rgba.push_back(static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(alpha[pixel], 0.0f, 1.0f))));
  }
  return rgba;
}

}  // namespace

void check_output(const std::string& output) {
  const Target target = target_of(output);
  if (target.path != "-") check_writable(target.path);
}

void write_output(const std::string& output, const Frame& frame, const OutputOptions& options) {
  const Target target = target_of(output);
  std::vector<std::byte> bytes;
  if (target.format == "exr") {
    LayeredImage image = frame.to_layered_image();
    image.metadata = options.metadata;
    bytes = encode_exr(image);
  } else if (target.format == "slice") {
    bytes = encode_frame(frame, options.identity, options.note);
  } else if (target.format == "hdr") {
    bytes = encode_hdr(frame.color_image());
  } else if (target.format == "pfm") {
    bytes = encode_pfm(frame.color_image());
  } else if (target.format == "png" && frame.aovs().has(Aov::alpha)) {
    bytes = encode_png(frame.width(), frame.height(), 4, straight_rgba8(frame, options));
  } else {
    const std::vector<std::uint8_t> pixels = to_srgb8(frame.color_image(), options.tone_map, options.exposure_ev);
    bytes =
        target.format == "png" ? encode_png(frame.width(), frame.height(), 3, pixels) : encode_jpeg(frame.width(), frame.height(), pixels);
  }
  write_file(target.path, bytes);
}

bool has_number(const std::string& output) { return output.find('#') != std::string::npos; }

std::string numbered(const std::string& output, int frame_number) {
  const std::size_t first = output.find('#');
  if (first == std::string::npos) return output;
  const std::size_t end = std::min(output.find_first_not_of('#', first), output.size());
  return output.substr(0, first) + fmt::format("{:0{}}", frame_number, end - first) + output.substr(end);
}

}  // namespace sightline
