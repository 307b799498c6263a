#include "shade/lights/environment_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>
#include <utility>

#include "base/core/error.h"
#include "image/tone_map.h"
#include "shade/cube_map.h"

namespace sightline {
namespace {

/// Equal-area map of the square to the sphere by its eight triangles. Within one, the distance from the centre gives z by
/// 1 - |z| = r², so that rings have the area they need, and the position along the ring gives the azimuth.
Vec3 octahedral_direction(const Vec2& uv) {
  const float x = 2 * uv.x - 1, y = 2 * uv.y - 1;
  const float ax = std::fabs(x), ay = std::fabs(y);
  const float height = 1 - (ax + ay);  // negative in the corners, the lower hemisphere
  const float r = 1 - std::fabs(height);
  const float azimuth = r > 0 ? 0.25f * kPi * ((ay - ax) / r + 1) : 0.f;
  const float z = std::copysign(1 - r * r, height);
  const float sine = r * std::sqrt(std::max(0.f, 2 - r * r));
  return {std::copysign(std::cos(azimuth), x) * sine, std::copysign(std::sin(azimuth), y) * sine, z};
}

Vec2 octahedral_uv(const Vec3& d) {
  const float ax = std::fabs(d.x), ay = std::fabs(d.y);
  // 1 - |z| from the sine, which keeps its digits near the poles.
  const float r = std::sqrt((ax * ax + ay * ay) / (1 + std::fabs(d.z)));
  const float ring = ax > 0 || ay > 0 ? 2 * kInvPi * std::atan2(ay, ax) : 0.f;  // 0 on the x axis, 1 on the y axis
  float py = ring * r, px = r - py;
  if (d.z < 0) std::tie(px, py) = std::pair(1 - py, 1 - px);
  return {0.5f * (1 + std::copysign(px, d.x)), 0.5f * (1 + std::copysign(py, d.y))};
}

std::shared_ptr<const Image> as_clean_floats(std::shared_ptr<const Image> image, const Context& context) {
  const std::size_t count = image->pixel_count() * static_cast<std::size_t>(std::max(image->channels, 0));
  const std::size_t stored = std::visit([](const auto& v) { return v.size(); }, image->data);
  if (image->width <= 0 || image->height <= 0 || image->channels < 1 || image->channels > 4 || stored != count) {
    throw input_error(fmt::format("a picture of {} x {} pixels, {} channels and {} values cannot be an environment", image->width,
                                  image->height, image->channels, stored));
  }
  const auto bad = [](float v) { return !(v >= 0 && std::isfinite(v)); };
  std::size_t bad_count = 0;
  if (const auto* floats = std::get_if<Image::Floats>(&image->data)) {
    bad_count = static_cast<std::size_t>(std::count_if(floats->begin(), floats->end(), bad));
    if (bad_count == 0) return image;
    context.warn(fmt::format("environment: {} negative or non-finite values are taken as 0", bad_count));
  }
  Image::Floats values(count);
  std::size_t i = 0;
  for (int y = 0; y < image->height; ++y) {
    for (int x = 0; x < image->width; ++x) {
      for (int c = 0; c < image->channels; ++c) {
        const float v = image->value(x, y, c);
        values[i++] = image->is_float() ? (bad(v) ? 0.f : v) : linear_from_srgb(v);
      }
    }
  }
  return std::make_shared<const Image>(Image{image->width, image->height, image->channels, std::move(values)});
}

}  // namespace

Vec2 environment_uv(EnvironmentMapping mapping, const Vec3& d) {
  switch (mapping) {
    case EnvironmentMapping::latlong: {
      // The polar angle by atan2: acos loses half of its digits near the poles.
      const float theta = std::atan2(std::sqrt(d.x * d.x + d.z * d.z), d.y);
      return {0.5f + std::atan2(d.x, 0 - d.z) * (0.5f * kInvPi), theta * kInvPi};
    }
    case EnvironmentMapping::angular: {
      const float sine = std::sqrt(d.x * d.x + d.y * d.y);
      const float radius = std::atan2(sine, -d.z) * kInvPi;
      const Vec2 turn = sine > 0 ? Vec2(d.x, d.y) / sine : Vec2(1, 0);
      return {0.5f + 0.5f * radius * turn.x, 0.5f - 0.5f * radius * turn.y};
    }
    case EnvironmentMapping::octahedral:
      return octahedral_uv(d);
    case EnvironmentMapping::cube: {
      // A border of a face must not round into the face below it.
      constexpr float kInside = 1e-6f;
      const CubePlace place = cube_place(d);
      const float v = std::clamp(0.5f * (place.v + 1), kInside, 1 - kInside);
      return {0.5f * (place.u + 1), (static_cast<float>(place.face) + v) / kCubeFaces};
    }
  }
  return Vec2(0.5f);
}

Vec3 environment_direction(EnvironmentMapping mapping, const Vec2& uv) {
  switch (mapping) {
    case EnvironmentMapping::latlong: {
      const float theta = kPi * uv.y, phi = 2 * kPi * (uv.x - 0.5f);
      const float sine = std::sin(theta);
      return {sine * std::sin(phi), std::cos(theta), -sine * std::cos(phi)};
    }
    case EnvironmentMapping::angular: {
      const Vec2 p{2 * uv.x - 1, 1 - 2 * uv.y};
      const float radius = glm::length(p);
      if (radius > 1) return Vec3(0);
      const float theta = kPi * radius;
      const float scale = radius > 0 ? std::sin(theta) / radius : 0.f;
      return {p.x * scale, p.y * scale, -std::cos(theta)};
    }
    case EnvironmentMapping::octahedral:
      return octahedral_direction(uv);
    case EnvironmentMapping::cube: {
      const float row = std::clamp(uv.y, 0.f, 1.f) * kCubeFaces;
      const int face = std::min(static_cast<int>(row), kCubeFaces - 1);
      return glm::normalize(cube_direction(face, 2 * uv.x - 1, 2 * (row - static_cast<float>(face)) - 1));
    }
  }
  return Vec3(0);
}

EnvironmentMap::EnvironmentMap(std::shared_ptr<const Image> image, EnvironmentMapping mapping, const Context& context)
    : image_(as_clean_floats(std::move(image), context)),
      mapping_(mapping),
      values_(std::get<Image::Floats>(image_->data).data()),
      channels_(image_->channels) {
  if (mapping == EnvironmentMapping::cube && image_->height != kCubeFaces * image_->width) {
    throw input_error(fmt::format("a picture of {} x {} pixels is no cube map: six square faces below one another are needed",
                                  image_->width, image_->height));
  }
}

IVec2 EnvironmentMap::cube_texel(const Vec3& direction) const {
  const CubePlace place = cube_place(direction);
  const int size = image_->width;
  const auto index = [size](float u) { return std::clamp(static_cast<int>((u + 1) * 0.5f * static_cast<float>(size)), 0, size - 1); };
  return {index(place.u), place.face * size + index(place.v)};
}

Color EnvironmentMap::texel(int x, int y) const {
  const int w = image_->width, h = image_->height;
  if (mapping_ == EnvironmentMapping::octahedral) {
    // Beyond an edge the square goes on mirrored about the middle of that edge; beyond a corner at the opposite corner.
    if (x < 0 || x >= w) {
      x = x < 0 ? 0 : w - 1;
      y = h - 1 - y;
    }
    if (y < 0 || y >= h) {
      y = y < 0 ? 0 : h - 1;
      x = w - 1 - x;
    }
  } else if (mapping_ == EnvironmentMapping::latlong) {
    if (x < 0) x += w;
    if (x >= w) x -= w;
  }
  x = std::clamp(x, 0, w - 1);
  y = std::clamp(y, 0, h - 1);
  const float* v = values_ + (static_cast<std::size_t>(y) * static_cast<std::size_t>(w) + static_cast<std::size_t>(x)) *
                                 static_cast<std::size_t>(channels_);
  return channels_ >= 3 ? Color(v[0], v[1], v[2]) : Color(v[0]);
}

Color EnvironmentMap::radiance_uv(const Vec2& uv) const {
  if (mapping_ == EnvironmentMapping::cube) {
    const auto index = [](float u, int n) { return static_cast<int>(std::clamp(u, 0.f, 1.f) * static_cast<float>(n)); };
    return texel(index(uv.x, image_->width), index(uv.y, image_->height));
  }
  const float x = std::clamp(uv.x, 0.f, 1.f) * static_cast<float>(image_->width) - 0.5f;
  const float y = std::clamp(uv.y, 0.f, 1.f) * static_cast<float>(image_->height) - 0.5f;
  const float left = std::floor(x), top = std::floor(y);
  const float fx = x - left, fy = y - top;
  const int i = static_cast<int>(left), j = static_cast<int>(top);
  const Color upper = (1 - fx) * texel(i, j) + fx * texel(i + 1, j);
  const Color lower = (1 - fx) * texel(i, j + 1) + fx * texel(i + 1, j + 1);
  return (1 - fy) * upper + fy * lower;
}

}  // namespace sightline
