#include "shade/lights/cube_resample.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/core/error.h"
#include "base/math/vec3_batch.h"
#include "base/parallel/parallel.h"
#include "scene/materialize.h"
#include "shade/cube_map.h"
#include "shade/lights/environment_lanes.h"
#include "shade/lights/environment_map.h"

namespace sightline {

// Points in all, so that large pictures take a second or two and not a minute.
constexpr double kMostPoints = 6.4e7;

namespace {

/// Radiance from the first `count` of these directions.
using RadianceBatch = std::function<void(const Vec3Batch& direction, std::size_t count, Vec3Batch& radiance)>;

std::vector<Color> resample_batches(const RadianceBatch& radiance, int size, int points, const Context& context) {
  const auto n = static_cast<std::size_t>(size), row_points = static_cast<std::size_t>(points);
  std::vector<Color> texels(kCubeFaces * n * n);
  const int fine = size * points;
  parallel_for(context, kCubeFaces * n, 4, [&](std::size_t begin, std::size_t end) {
    Vec3Batch direction, color;
    direction.resize(row_points), color.resize(row_points);
    std::vector<double> weight(row_points);
    for (std::size_t row = begin; row < end; ++row) {
      const int face = static_cast<int>(row / n), y = static_cast<int>(row % n);
      for (int x = 0; x < size; ++x) {
        glm::dvec3 sum(0);
        double weights = 0;
        for (int j = 0; j < points; ++j) {
          for (int i = 0; i < points; ++i) {
            const Vec3 d = cube_direction(face, cube_coordinate(x * points + i, fine), cube_coordinate(y * points + j, fine));
            // Solid angles of equal parts of a face fall with the cube of the distance to it.
            const float squared = length_squared(d), length = std::sqrt(squared);
            weight[static_cast<std::size_t>(i)] = 1 / (static_cast<double>(squared) * static_cast<double>(length));
            store(direction, static_cast<std::size_t>(i), d / length);
          }
          radiance(direction, row_points, color);
          for (std::size_t i = 0; i < row_points; ++i) {
            sum += weight[i] * glm::dvec3(load(color, i));
            weights += weight[i];
          }
        }
        texels[row * n + static_cast<std::size_t>(x)] = Color(sum / weights);
      }
    }
  });
  return texels;
}

}  // namespace

std::vector<Color> resample_to_cube(const std::function<Color(const Vec3&)>& radiance, int size, int points, const Context& context) {
  const auto one_by_one = [&](const Vec3Batch& direction, std::size_t count, Vec3Batch& color) {
    for (std::size_t i = 0; i < count; ++i) store(color, i, radiance(load(direction, i)));
  };
  return resample_batches(one_by_one, size, points, context);
}

int cube_points(const Environment& environment, int size) {
  if (!environment.image) return 1;
  // Pixels from one edge of a face to the other, at the middle of the face, where they are smallest as seen on it. A single bright pixel
  // is read as a hat of twice its width: four points a pixel find its integral to within a hundredth wherever they fall.
  const double pixels_a_face = 4 / std::numbers::pi * std::max(environment.image->width / 4, environment.image->height / 2);
  const double most = std::sqrt(kMostPoints / kCubeFaces) / size;
  return std::max(16, static_cast<int>(std::ceil(std::min(4 * pixels_a_face / size, most))));
}

namespace {

/// From cube map to cube map exactly: texels overlap in rectangles of a face.
std::vector<Color> resample_cube(const EnvironmentMap& source, int size, const Context& context) {
  const int fine = source.width();
  const auto n = static_cast<std::size_t>(size);
  std::vector<Color> texels(kCubeFaces * n * n);
  // Border i of a grid of `count` on a face.
  const auto border = [](int i, int count) { return 2 * static_cast<double>(i) / count - 1; };
  const auto first = [&](int i) { return static_cast<int>(static_cast<std::int64_t>(i) * fine / size); };
  const auto last = [&](int i) { return static_cast<int>((static_cast<std::int64_t>(i + 1) * fine + size - 1) / size); };
  parallel_for(context, kCubeFaces * n, 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      const int face = static_cast<int>(row / n), y = static_cast<int>(row % n);
      for (int x = 0; x < size; ++x) {
        glm::dvec3 sum(0);
        double weights = 0;
        for (int j = first(y); j < last(y); ++j) {
          for (int i = first(x); i < last(x); ++i) {
            const auto lower = [&](int k, int t) { return static_cast<float>(std::max(border(k, fine), border(t, size))); };
            const auto upper = [&](int k, int t) { return static_cast<float>(std::min(border(k + 1, fine), border(t + 1, size))); };
            const auto weight = static_cast<double>(cube_solid_angle(lower(i, x), lower(j, y), upper(i, x), upper(j, y)));
            sum += weight * glm::dvec3(source.texel(i, face * fine + j));
            weights += weight;
          }
        }
        texels[row * n + static_cast<std::size_t>(x)] = Color(sum / weights);
      }
    }
  });
  return texels;
}

}  // namespace

Environment environment_as_cube(const Environment& environment, int size, const Context& context) {
  if (size < 1 || size > kMaxCubeSize) {
    throw usage_error(fmt::format("a cube map with faces of {0} x {0} texels is not possible", size))
        .remedy(fmt::format("choose a size from 1 to {}", kMaxCubeSize));
  }
  // Colours twice while the picture is made, then the sampler's tables.
  require_memory(context, kCubeFaces * static_cast<std::uint64_t>(size) * static_cast<std::uint64_t>(size) * (2 * sizeof(Color) + 16),
                 "the environment's cube map");
  Environment cube = environment;
  cube.mapping = EnvironmentMapping::cube;
  std::vector<Color> texels;
  if (!environment.image) {
    texels.assign(kCubeFaces * static_cast<std::size_t>(size) * static_cast<std::size_t>(size), Color(1));
  } else {
    const EnvironmentMap map(environment.image, environment.mapping, context);
    if (environment.mapping == EnvironmentMapping::cube && map.width() == size) return environment;
    if (environment.mapping == EnvironmentMapping::cube) {
      texels = resample_cube(map, size, context);
    } else {
      const EnvironmentPicture picture{map.values(), map.width(), map.height(), map.channels(), map.mapping(), Mat3(1), Color(1)};
      const int points = cube_points(environment, size);
      texels = picture.has_lanes() ? resample_batches([&](const Vec3Batch& d, std::size_t count,
                                                          Vec3Batch& color) { environment_radiance(picture, d, count, color); },
                                                      size, points, context)
                                   : resample_to_cube([&](const Vec3& d) { return map.radiance(d); }, size, points, context);
    }
  }
  Image::Floats values;
  values.reserve(3 * texels.size());
  for (const Color& c : texels) values.insert(values.end(), {c.x, c.y, c.z});
  cube.image = std::make_shared<const Image>(Image{size, kCubeFaces * size, 3, std::move(values)});
  return cube;
}

}  // namespace sightline
