#include "scene/load/pbrt/environment.h"

#include <cmath>

namespace sightline::pbrt {

Vec3 equal_area_direction(const Vec2& point) {
  const float u = 2 * point.x - 1, v = 2 * point.y - 1;
  const float absolute_u = std::fabs(u), absolute_v = std::fabs(v);
  const float signed_distance = 1 - (absolute_u + absolute_v);  // from the diagonal between the hemispheres
  const float r = 1 - std::fabs(signed_distance);
  const float phi = (r == 0 ? 1 : (absolute_v - absolute_u) / r + 1) * kPi / 4;
  const float z = std::copysign(1 - r * r, signed_distance);
  const float sine = r * std::sqrt(std::fmax(0.f, 2 - r * r));
  return {std::copysign(std::cos(phi), u) * sine, std::copysign(std::sin(phi), v) * sine, z};
}

double upper_illuminance(const Image& image) {
  double sum = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const Vec3 w = equal_area_direction({(static_cast<float>(x) + 0.5f) / static_cast<float>(image.width),
                                           (static_cast<float>(y) + 0.5f) / static_cast<float>(image.height)});
      if (w.z <= 0) continue;
      const bool is_gray = image.channels < 3;
      const Color color(image.value(x, y, 0), image.value(x, y, is_gray ? 0 : 1), image.value(x, y, is_gray ? 0 : 2));
      sum += static_cast<double>(luminance(color) * w.z);
    }
  }
  // All pixels cover the same solid angle, 4 pi over their number.
  return 4 * static_cast<double>(kPi) * sum / static_cast<double>(image.pixel_count());
}

glm::mat3 latlong_of_v3() { return {Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(1, 0, 0)}; }

}  // namespace sightline::pbrt
