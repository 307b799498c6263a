// How position and direction of a ray change with the picture position: from the camera over mirrors and glass [Igehy1999].
#pragma once

#include <cmath>
#include <cstdint>

#include "base/math/vec.h"
#include "film/view.h"
#include "world/surface.h"

namespace sightline {

/// Changes of a ray's point and unit direction along two axes x and y of what is sampled: the pixel grid, or the lens.
struct RayDifferential {
  Vec3 dp_dx{0}, dp_dy{0}, dd_dx{0}, dd_dy{0};

  /// Area across unit `direction` that the parallelogram of both steps has after distance `t`. Over the cosine to a surface it is the area
  /// there.
  float cross_section(const Vec3& direction, float t) const {
    return std::fabs(glm::dot(direction, glm::cross(dp_dx + t * dd_dx, dp_dy + t * dd_dy)));
  }

  /// Carried along unit `direction` by `t` onto a surface with unit normal `normal` [Igehy1999, Eq. 10].
  RayDifferential transferred(const Vec3& direction, float t, const Vec3& normal) const {
    // Nearly tangential rays step out of the surface rather than to infinity.
    constexpr float kLeastCosine = 1e-4f;
    const float cosine = glm::dot(direction, normal);
    const Vec3 slide = direction / std::copysign(std::fmax(std::fabs(cosine), kLeastCosine), cosine);
    const Vec3 across_x = dp_dx + t * dd_dx, across_y = dp_dy + t * dd_dy;
    return {across_x - slide * glm::dot(across_x, normal), across_y - slide * glm::dot(across_y, normal), dd_dx, dd_dy};
  }
};

/// Change of the shading normal along each axis, for points that move as `at_hit` (already transferred) says.
struct NormalChange {
  Vec3 dn_dx{0}, dn_dy{0};
};
inline NormalChange normal_change(const SurfaceDetail& detail, const RayDifferential& at_hit) {
  if (detail.dn_du == Vec3(0) && detail.dn_dv == Vec3(0)) return {};
  // Steps in the surface expressed in uv by least squares.
  const Vec3 &du = detail.dp_du, &dv = detail.dp_dv;
  const float uu = glm::dot(du, du), uv = glm::dot(du, dv), vv = glm::dot(dv, dv), determinant = uu * vv - uv * uv;
  const auto turn = [&](const Vec3& step) {
    const float a = glm::dot(step, du), b = glm::dot(step, dv);
    const Vec3 dn = ((vv * a - uv * b) / determinant) * detail.dn_du + ((uu * b - uv * a) / determinant) * detail.dn_dv;
    return is_finite(dn) ? dn : Vec3(0);
  };
  return {turn(at_hit.dp_dx), turn(at_hit.dp_dy)};
}

/// After a mirror that turns unit `direction` about unit `normal` [Igehy1999, Eq. 14].
inline RayDifferential reflected(const RayDifferential& at_hit, const Vec3& direction, const Vec3& normal, const NormalChange& change) {
  const auto turn = [&](const Vec3& dd, const Vec3& dn) {
    const float cosine_change = glm::dot(dd, normal) + glm::dot(direction, dn);
    return dd - 2.f * (glm::dot(direction, normal) * dn + cosine_change * normal);
  };
  return {at_hit.dp_dx, at_hit.dp_dy, turn(at_hit.dd_dx, change.dn_dx), turn(at_hit.dd_dy, change.dn_dy)};
}

/// After an interface that bends unit `direction` to unit `refracted_direction`; `eta` is the far index over the near one [Igehy1999, Eq.
/// 19]. Either sign of `normal` will do.
inline RayDifferential refracted(const RayDifferential& at_hit, const Vec3& direction, const Vec3& refracted_direction, const Vec3& normal,
                                 float eta, const NormalChange& change) {
  // At the critical angle the refracted ray turns infinitely fast.
  constexpr float kLeastCosine = 1e-3f;
  const float ratio = 1 / eta, cos_near = glm::dot(direction, normal), cos_far = glm::dot(refracted_direction, normal);
  const float bounded_far = std::copysign(std::fmax(std::fabs(cos_far), kLeastCosine), cos_far);
  const float mu = ratio * cos_near - cos_far, mu_rate = ratio - ratio * ratio * cos_near / bounded_far;
  const auto turn = [&](const Vec3& dd, const Vec3& dn) {
    const float cosine_change = glm::dot(dd, normal) + glm::dot(direction, dn);
    return ratio * dd - (mu * dn + mu_rate * cosine_change * normal);
  };
  return {at_hit.dp_dx, at_hit.dp_dy, turn(at_hit.dd_dx, change.dn_dx), turn(at_hit.dd_dy, change.dn_dy)};
}

/// Differentials of a view's rays where they leave it, a step being the spacing of samples.
class CameraDifferential {
 public:
  CameraDifferential(const View& view, std::uint32_t samples_a_pixel) {
    const PinholeRays plane = view.pinhole();
    const float samples = static_cast<float>(samples_a_pixel > 0 ? samples_a_pixel : 1), spacing = 1 / std::sqrt(samples);
    step_x_ = spacing * plane.step_x, step_y_ = spacing * plane.step_y;
    const Vec3 across = glm::cross(step_x_, step_y_);
    axis_ = normalize_or(across, Vec3(0, 0, 1));
    orthographic_ = plane.orthographic;
    step_area_ = glm::length(across);
    if (orthographic_) return;
    plane_distance_ = std::fmax(std::fabs(glm::dot(plane.origin, axis_)), 1e-20f);
    if (!view.has_lens()) return;
    // Steps as long as make a square of the disk's area, to be shared by a pixel's samples.
    const float radius = view.camera().lens_radius * std::sqrt(kPi / samples);
    lens_x_ = radius * Vec3(view.world_from_camera()[0]), lens_y_ = radius * Vec3(view.world_from_camera()[1]);
    focal_distance_ = std::fmax(view.camera().focal_distance * plane_distance_, 1e-20f);
    lens_area_ = glm::length(glm::cross(lens_x_, lens_y_));
  }

  bool has_lens() const { return lens_area_ > 0; }

  /// With the pixel, of the camera ray along unit `direction`: the plane's point is as far as plane_distance over the cosine.
  RayDifferential pixel(const Vec3& direction) const {
    if (orthographic_) return {step_x_, step_y_, Vec3(0), Vec3(0)};
    const float scale = std::fabs(glm::dot(direction, axis_)) / plane_distance_;
    return {Vec3(0), Vec3(0), scale * across(step_x_, direction), scale * across(step_y_, direction)};
  }
  /// With the lens: rays through all of it meet in one point of the focal plane.
  RayDifferential lens(const Vec3& direction) const {
    const float scale = -std::fabs(glm::dot(direction, axis_)) / focal_distance_;
    return {lens_x_, lens_y_, scale * across(lens_x_, direction), scale * across(lens_y_, direction)};
  }

  /// Area across the ray that a sample stands for at distance `t`: pixel(direction).cross_section(direction, t) and the same of the lens,
  /// whose blur is independent, so that areas add. Multiplied out.
  float cross_section(const Vec3& direction, float t) const {
    const float cosine = std::fabs(glm::dot(direction, axis_));
    if (orthographic_) return step_area_ * cosine;
    const float scale = cosine * t / plane_distance_;
    float area = step_area_ * cosine * scale * scale;
    if (lens_area_ > 0) {
      const float blur = 1 - cosine * t / focal_distance_;
      area += lens_area_ * cosine * blur * blur;
    }
    return area;
  }

 private:
  static Vec3 across(const Vec3& v, const Vec3& direction) { return v - direction * glm::dot(direction, v); }

  Vec3 step_x_, step_y_, axis_, lens_x_{0}, lens_y_{0};
  float step_area_ = 0, lens_area_ = 0, plane_distance_ = 1, focal_distance_ = 1;
  bool orthographic_ = false;
};

}  // namespace sightline
