#include "shade/lights/sphere_sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/math/frame.h"
#include "base/sample/warp.h"

namespace sightline {
namespace {

/// Where a point is relative to the sphere, and 1 - cos of the half angle under which it sees it.
struct Cone {
  bool outside;
  Vec3 axis;  ///< unit, towards the centre
  float center_distance;
  float sin_squared;
  float one_minus_cos;
};

Cone cone_of(const SphereEmitter& sphere, const Vec3& position) {
  const Vec3 to_center = sphere.center - position;
  const float distance = glm::length(to_center);
  if (!(distance > sphere.radius)) return {false, {0, 0, 1}, distance, 1, 1};
  const float ratio = sphere.radius / distance;
  const float sin_squared = ratio * ratio;
  // 1 - sqrt(1 - s) = s / (1 + sqrt(1 - s)) keeps its digits for far spheres.
  return {true, to_center / distance, distance, sin_squared, sin_squared / (1 + std::sqrt(std::max(0.f, 1 - sin_squared)))};
}

}  // namespace

float sphere_point_error(const SphereEmitter& sphere) {
  const float largest = std::max({std::fabs(sphere.center.x), std::fabs(sphere.center.y), std::fabs(sphere.center.z)});
  return 4 * std::numeric_limits<float>::epsilon() * (largest + sphere.radius);
}

LightSample sample_sphere(const SphereEmitter& sphere, std::uint32_t index, float selection, const Vec3& position, const Vec2& u) {
  LightSample s;
  s.light = index;
  s.is_mesh = sphere.is_mesh;
  s.point_error = sphere_point_error(sphere);
  s.radiance = sphere.radiance;

  const Cone cone = cone_of(sphere, position);
  Vec3 outward;
  if (cone.outside) {
    const Vec3 local = sample_uniform_cone(u, cone.one_minus_cos);
    const Vec3 direction = frame_from_normal(cone.axis).to_world(local);
    // Nearer of the two intersections; the root vanishes where the ray grazes.
    const float sin_squared = local.x * local.x + local.y * local.y;
    const float depth = std::sqrt(std::max(0.f, cone.sin_squared - sin_squared)) * cone.center_distance;
    const float along = cone.center_distance * local.z - depth;
    outward = normalize_or(position + along * direction - sphere.center, -cone.axis);
  } else {
    outward = sample_uniform_sphere(u);
  }
  s.point = sphere.center + sphere.radius * outward;
  const Vec3 to_point = s.point - position;
  s.distance = glm::length(to_point);
  s.wi = s.distance > 0 ? to_point / s.distance : Vec3(0);
  s.normal = cone.outside ? outward : -outward;
  s.pdf = pdf_sphere(sphere, selection, position, s.point);
  if (!(s.pdf > 0)) s.radiance = Color(0);
  return s;
}

float pdf_sphere(const SphereEmitter& sphere, float selection, const Vec3& position, const Vec3& hit) {
  const Cone cone = cone_of(sphere, position);
  if (cone.outside) {
    if (!sphere.emits_outside) return 0;
    const float pdf = selection * pdf_uniform_cone(cone.one_minus_cos);
    return std::isfinite(pdf) ? pdf : 0.f;
  }
  if (!sphere.emits_inside) return 0;
  const Vec3 to_point = hit - position;
  const float squared = length_squared(to_point);
  const float facing = glm::dot(to_point, normalize_or(hit - sphere.center, Vec3(0)));
  const float area = 4 * kPi * sphere.radius * sphere.radius;
  const float pdf = selection * (squared * std::sqrt(squared)) / (area * facing);
  return facing > 0 && std::isfinite(pdf) ? pdf : 0.f;
}

}  // namespace sightline
