#include "methods/square_lights/light_cube.h"

#include <algorithm>
#include <cmath>

#include "shade/lights/cube_resample.h"
#include "shade/lights/environment_map.h"

namespace sightline::square_lights {
namespace {

struct Place {
  int face, x, y;
};

Place place_of(std::size_t texel, int size) {
  const auto n = static_cast<std::size_t>(size);
  return {static_cast<int>(texel / (n * n)), static_cast<int>(texel % n), static_cast<int>(texel / n % n)};
}

}  // namespace

Vec3 LightCube::center(std::size_t texel) const {
  const Place p = place_of(texel, size);
  return glm::normalize(cube_direction(p.face, cube_coordinate(p.x, size), cube_coordinate(p.y, size)));
}

float LightCube::solid_angle(std::size_t texel) const {
  const Place p = place_of(texel, size);
  return cube_texel_solid_angle(p.x, p.y, size);
}

std::size_t LightCube::texel_of(const Vec3& direction) const {
  const CubePlace place = cube_place(direction);
  const auto column = [this](float u) {
    return static_cast<std::size_t>(std::clamp(static_cast<int>((u + 1) * 0.5f * static_cast<float>(size)), 0, size - 1));
  };
  const auto n = static_cast<std::size_t>(size);
  return (static_cast<std::size_t>(place.face) * n + column(place.v)) * n + column(place.u);
}

Color LightCube::integral() const {
  // All faces are alike, and solid angles take four arcus tangents each.
  const std::size_t face_texels = static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
  glm::dvec3 sum(0);
  for (std::size_t i = 0; i < face_texels; ++i) {
    const double weight = solid_angle(i);
    for (std::size_t face = 0; face < kCubeFaces; ++face) sum += weight * glm::dvec3(texels[face * face_texels + i]);
  }
  return Color(sum);
}

LightCube make_light_cube(const std::function<Color(const Vec3&)>& radiance, int size, int points, const Context& context) {
  LightCube cube;
  cube.size = size;
  cube.texels = resample_to_cube(radiance, size, points, context);
  return cube;
}

LightCube light_cube_of(const Environment& environment, int size, const Context& context) {
  LightCube cube;
  cube.size = size;
  const Environment resampled = environment_as_cube(environment, size, context);
  const EnvironmentMap map(resampled.image, resampled.mapping, context);
  const Color scale = glm::max(environment.scale, Color(0));
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) cube.texels.push_back(scale * map.texel(x, y));
  }
  return cube;
}

}  // namespace sightline::square_lights
