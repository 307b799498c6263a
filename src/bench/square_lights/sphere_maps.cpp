#include "bench/square_lights/sphere_maps.h"

#include <cmath>
#include <functional>
#include <vector>

#include "base/math/frame.h"
#include "methods/square_lights/square_fit.h"
#include "shade/lights/environment_map.h"

namespace sightline {
namespace {

constexpr int kMapWidth = 400, kMapHeight = 200, kCubePoints = 16;

ColorImage picture_of(const std::function<Color(const Vec3&)>& color) {
  ColorImage image(kMapWidth, kMapHeight);
  for (int y = 0; y < kMapHeight; ++y) {
    for (int x = 0; x < kMapWidth; ++x) {
      const Vec2 uv((static_cast<float>(x) + 0.5f) / kMapWidth, (static_cast<float>(y) + 0.5f) / kMapHeight);
      image.at(x, y) = color(environment_direction(EnvironmentMapping::latlong, uv));
    }
  }
  return image;
}

/// Colours that neighbours are told apart by: hues by the golden ratio.
Color region_color(std::size_t i) {
  const float hue = 6 * std::fmod(0.618034f * static_cast<float>(i), 1.f), level = 0.35f + 0.15f * static_cast<float>(i % 4);
  const auto channel = [&](float shift) {
    const float h = std::fmod(hue + shift, 6.f);
    return level * (0.25f + 0.75f * std::fmin(1.f, std::fmax(0.f, std::fabs(h - 3) - 1)));
  };
  return {channel(0), channel(4), channel(2)};
}

}  // namespace

using namespace square_lights;

LightCube bench_light_cube(const World& world, int size, const Context& context) {
  const Mat3 turn = world.scene().environment->world_from_environment;
  return make_light_cube([&](const Vec3& d) { return world.lights().environment(turn * d); }, size, kCubePoints, context);
}

ColorImage cube_picture(const LightCube& cube) {
  return picture_of([&](const Vec3& d) { return cube.texels[cube.texel_of(d)]; });
}

ColorImage region_picture(const LightCube& cube, const MergeTree& tree, std::size_t count) {
  std::vector<std::uint32_t> region(cube.count());
  std::uint32_t index = 0;
  for (const std::int32_t root : tree.cut(count)) {
    std::vector<std::int32_t> below = {root};
    while (!below.empty()) {
      const auto node = static_cast<std::size_t>(below.back());
      below.pop_back();
      if (node < tree.texels()) {
        region[node] = index;
        continue;
      }
      below.push_back(tree.nodes()[node].left), below.push_back(tree.nodes()[node].right);
    }
    ++index;
  }
  return region_picture(cube, region);
}

ColorImage region_picture(const LightCube& cube, std::span<const std::uint32_t> region) {
  return picture_of([&](const Vec3& d) { return region_color(region[cube.texel_of(d)]); });
}

ColorImage square_picture(const MergeTree& tree, std::size_t count) { return square_picture(tree.lights(count)); }

ColorImage square_picture(std::span<const SquareLight> lights) {
  struct Placed {
    SquareLight light;
    Frame3 frame;
  };
  std::vector<Placed> placed;
  for (const SquareLight& light : lights) {
    const Vec3 east = std::fabs(light.center.y) < 0.999f ? glm::cross(Vec3(0, 1, 0), light.center) : Vec3(1, 0, 0);
    placed.push_back({light, frame_from_normal_tangent(light.center, glm::normalize(east))});
  }
  return picture_of([&](const Vec3& d) {
    Color sum(0);
    for (const Placed& p : placed) {
      const Vec2 at = lambert_azimuthal(p.frame.to_local(d));
      const float half = p.light.radius * 0.70710678f;
      if (std::fabs(at.x) <= half && std::fabs(at.y) <= half) sum += p.light.radiance;
    }
    return sum;
  });
}

}  // namespace sightline
