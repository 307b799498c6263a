#include "session/options_text.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "base/core/error.h"
#include "base/settings/settings.h"

namespace sightline {
namespace {

std::vector<std::string_view> split(std::string_view text, std::string_view separators) {
  std::vector<std::string_view> parts;
  std::size_t at = 0;
  while (true) {
    const std::size_t begin = text.find_first_not_of(separators, at);
    if (begin == std::string_view::npos) return parts;
    const std::size_t end = std::min(text.find_first_of(separators, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    at = end;
  }
}

Error malformed(std::string_view option, std::string_view text, std::string_view form) {
  return usage_error(fmt::format("{} '{}' is not of the form {}", option, text, form));
}

float parse_float(std::string_view option, std::string_view text) {
  const float value = static_cast<float>(parse_real(option, text, SettingInfo{}));
  if (!std::isfinite(value)) throw usage_error(fmt::format("{} '{}' is not finite", option, text));
  return value;
}

Vec2 parse_extent(std::string_view option, std::string_view text) {
  const std::size_t x = text.find('x');
  if (x == std::string_view::npos) throw malformed(option, text, "WxH");
  const Vec2 size{parse_float(option, text.substr(0, x)), parse_float(option, text.substr(x + 1))};
  if (!(size.x > 0 && size.y > 0)) throw usage_error(fmt::format("{} '{}' must be larger than 0", option, text));
  return size;
}

std::vector<std::string_view> light_fields(std::string_view option, std::string_view text, std::size_t count, std::string_view form) {
  std::vector<std::string_view> fields = split(text, " \t");
  if (fields.size() != count) throw malformed(option, text, form);
  return fields;
}

Vec3 parse_direction(std::string_view option, std::string_view text) {
  const Vec3 v = parse_vec3(option, text);
  if (!(length_squared(v) > 0)) throw usage_error(fmt::format("{} '{}' has no direction", option, text));
  return glm::normalize(v);
}

}  // namespace

Vec3 parse_vec3(std::string_view option, std::string_view text) {
  const std::vector<std::string_view> parts = split(text, ",");
  if (parts.size() != 3) throw malformed(option, text, "X,Y,Z");
  return {parse_float(option, parts[0]), parse_float(option, parts[1]), parse_float(option, parts[2])};
}

IVec2 parse_size(std::string_view option, std::string_view text) {
  const std::size_t x = text.find('x');
  if (x == std::string_view::npos) throw malformed(option, text, "WxH");
  const SettingInfo limits{.minimum = 1, .maximum = 65536};
  return {static_cast<int>(parse_integer(option, text.substr(0, x), limits)),
          static_cast<int>(parse_integer(option, text.substr(x + 1), limits))};
}

SampleRange parse_sample_range(std::string_view option, std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) throw malformed(option, text, "A:B");
  const SettingInfo limits{.minimum = 0, .maximum = 4294967295.0};
  const SampleRange range{static_cast<std::uint32_t>(parse_integer(option, text.substr(0, colon), limits)),
                          static_cast<std::uint32_t>(parse_integer(option, text.substr(colon + 1), limits))};
  if (range.begin >= range.end) throw usage_error(fmt::format("{} '{}' is empty", option, text)).remedy("A:B holds samples A to B - 1");
  return range;
}

FrameRange parse_frame_range(std::string_view option, std::string_view text) {
  FrameRange range;
  std::string_view frames = text;
  const SettingInfo limits{.minimum = 0, .maximum = 1e9};
  if (const std::size_t x = text.find('x'); x != std::string_view::npos) {
    range.step = static_cast<int>(parse_integer(option, text.substr(x + 1), {.minimum = 1, .maximum = 1e9}));
    frames = text.substr(0, x);
  }
  const std::size_t dash = frames.find('-');
  if (dash == std::string_view::npos) throw malformed(option, text, "A-B or A-BxS");
  range.first = static_cast<int>(parse_integer(option, frames.substr(0, dash), limits));
  range.last = static_cast<int>(parse_integer(option, frames.substr(dash + 1), limits));
  if (range.last < range.first) throw usage_error(fmt::format("{} '{}' ends before it begins", option, text));
  return range;
}

Light parse_light_area(std::string_view text) {
  constexpr std::string_view option = "--light-area";
  const auto fields = light_fields(option, text, 4, "\"X,Y,Z NX,NY,NZ WxH R,G,B\"");
  const Vec3 normal = parse_direction(option, fields[1]);
  const Vec2 size = parse_extent(option, fields[2]);
  RectangleLight light;
  light.center = parse_vec3(option, fields[0]);
  const Vec3 width_axis = std::fabs(normal.y) > 0.99f ? normalize_or(Vec3(1, 0, 0) - normal * normal.x, Vec3(1, 0, 0))
                                                      : glm::normalize(glm::cross(Vec3(0, 1, 0), normal));
  light.half_u = 0.5f * size.x * width_axis;
  light.half_v = 0.5f * size.y * glm::cross(normal, width_axis);
  light.radiance = parse_vec3(option, fields[3]);
  return {.name = std::string(option), .shape = light, .node = {}};
}

Light parse_light_point(std::string_view text) {
  constexpr std::string_view option = "--light-point";
  const auto fields = light_fields(option, text, 2, "\"X,Y,Z R,G,B\"");
  return {.name = std::string(option), .shape = PointLight{parse_vec3(option, fields[0]), parse_vec3(option, fields[1])}, .node = {}};
}

Light parse_light_directional(std::string_view text) {
  constexpr std::string_view option = "--light-directional";
  const auto fields = light_fields(option, text, 2, "\"DX,DY,DZ R,G,B\"");
  return {.name = std::string(option),
          .shape = DirectionalLight{parse_direction(option, fields[0]), parse_vec3(option, fields[1])},
          .node = {}};
}

}  // namespace sightline
