// Analytic spheres: intersection and parametrisation.
#pragma once

#include <cmath>
#include <optional>

#include "base/math/vec.h"
#include "scene/mesh.h"

namespace sightline {

/// First t in [t_near, t_far] at which the ray meets the sphere, from outside or from within. Works on the part of the ray next to the
/// centre, so that far spheres keep their precision [Haines2019].
inline std::optional<float> intersect_sphere(const Vec3& center, float radius, const Vec3& origin, const Vec3& direction, float t_near,
                                             float t_far) {
  const float inverse_length2 = 1 / length_squared(direction);
  const Vec3 to_center = center - origin;
  const float t_middle = glm::dot(to_center, direction) * inverse_length2;
  const Vec3 perpendicular = to_center - t_middle * direction;
  const float rest = radius * radius - length_squared(perpendicular);
  if (!(rest >= 0) || !(radius > 0)) return std::nullopt;
  const float half_chord = std::sqrt(rest * inverse_length2);
  const float front = t_middle - half_chord, back = t_middle + half_chord;
  if (front >= t_near && front <= t_far) return front;
  if (back >= t_near && back <= t_far) return back;
  return std::nullopt;
}

/// Point of the surface nearest to `point`, in the sphere's own frame with unit radius: only `world_from_object`'s rotation counts.
inline Vec3 sphere_local_direction(const Sphere& sphere, const Vec3& point) {
  const Vec3 d = point - sphere.center;
  const Mat3 rotation{glm::normalize(Vec3(sphere.world_from_object[0])), glm::normalize(Vec3(sphere.world_from_object[1])),
                      glm::normalize(Vec3(sphere.world_from_object[2]))};
  return normalize_or(glm::transpose(rotation) * d, {0, 0, 1});
}

/// pbrt's parametrisation: u = longitude / 2 pi from +x towards +y, v = 0 at the south pole (-z) in pbrt, hence 1 here: textures of
/// pbrt scenes were flipped when they were loaded.
inline Vec2 sphere_uv(const Vec3& local_direction) {
  float phi = std::atan2(local_direction.y, local_direction.x);
  if (phi < 0) phi += 2 * kPi;
  const float theta = std::acos(std::fmin(1.f, std::fmax(-1.f, local_direction.z)));
  return {phi / (2 * kPi), theta / kPi};
}

}  // namespace sightline
