// The area of a surface that one camera sample stands for.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/math/vec.h"
#include "film/view.h"

namespace sightline {

/// a_e = 1 / (N_S P(p_e)) of a primary hit: the density of camera samples on the image plane carried over to the surface. With a lens, the
/// spot that the lens makes of a pixel is added.
class EyeFootprint {
 public:
  EyeFootprint(const View& view, float samples_a_pixel) : samples_(samples_a_pixel) {
    const PinholeRays plane = view.pinhole();
    const Vec3 across = glm::cross(plane.step_x, plane.step_y);
    pixel_area_ = glm::length(across);
    axis_ = normalize_or(across, Vec3(0, 0, 1));
    orthographic_ = plane.orthographic;
    // A scaled camera has its plane elsewhere than at distance 1.
    if (!orthographic_) {
      const float distance = glm::dot(plane.origin, axis_);
      pixel_area_ /= std::fmax(distance * distance, 1e-30f);
    }
    if (view.has_lens()) lens_radius_ = view.camera().lens_radius, focal_distance_ = view.camera().focal_distance;
  }

  /// Of a hit at `distance` along unit `direction` on a surface with unit `normal`.
  float area(const Vec3& direction, float distance, const Vec3& normal) const {
    // Grazing surfaces are not let grow without bound.
    const float cosine = std::fmax(std::fabs(glm::dot(direction, normal)), 0.05f);
    if (orthographic_) return pixel_area_ / (samples_ * cosine);
    const float cos_axis = std::fabs(glm::dot(direction, axis_));
    const float spot = lens_radius_ > 0 ? lens_radius_ * std::fabs(1 - distance * cos_axis / focal_distance_) : 0.f;
    return (pixel_area_ * cos_axis * cos_axis * cos_axis * distance * distance / cosine + kPi * spot * spot) / samples_;
  }

 private:
  float samples_, pixel_area_ = 0, lens_radius_ = 0, focal_distance_ = 1;
  Vec3 axis_{0, 0, 1};
  bool orthographic_ = false;
};

}  // namespace sightline
