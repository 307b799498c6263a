// The GGX micro-normal distribution with height-correlated Smith shadowing [Walter2007, Heitz2014].
#pragma once

#include <algorithm>
#include <cmath>

#include "base/sample/warp.h"

namespace sightline {

/// Slopes (alpha) along x and y. Below kSmooth in both the surface is a mirror; models then use a delta.
///
/// With s(w) = sqrt((alpha_x x)² + (alpha_y y)² + z²), Smith's masking is G1(w) = 2|z| / (|z| + s(w)) and the height-correlated
/// shadowing-masking is G2 = 2 |zo| |zi| / (|zo| s(wi) + |zi| s(wo)): no tangents, hence nothing that is singular at grazing angles.
class Ggx {
 public:
  static constexpr float kSmooth = 1e-3f;

  Ggx() = default;
  Ggx(float alpha_u, float alpha_v)
      : alpha_(std::clamp(alpha_u, kLeast, 1.f), std::clamp(alpha_v, kLeast, 1.f)), smooth_(!(std::max(alpha_u, alpha_v) >= kSmooth)) {}

  bool is_smooth() const { return smooth_; }
  const Vec2& alpha() const { return alpha_; }

  /// Density of micro-normals D(m), m.z > 0.
  float distribution(const Vec3& m) const {
    const Vec3 slope{m.x / alpha_.x, m.y / alpha_.y, m.z};
    const float shape = glm::dot(slope, slope);
    return kInvPi / (alpha_.x * alpha_.y * shape * shape);
  }
  /// G2 / (2 |zo|), which times D F / 2 is the reflected f |cos wi|.
  float shadowing_over_cosine(const Vec3& wo, const Vec3& wi) const {
    const float zo = std::fabs(wo.z), zi = std::fabs(wi.z);
    const float denominator = zo * stretch(wi) + zi * stretch(wo);
    return denominator > 0 ? zi / denominator : 0.f;
  }
  /// G1(wo) / (2 |zo|).
  float masking_over_cosine(const Vec3& wo) const { return 1 / (std::fabs(wo.z) + stretch(wo)); }
  /// s(w).
  float stretch(const Vec3& w) const {
    const float x = alpha_.x * w.x, y = alpha_.y * w.y;
    return std::sqrt(x * x + y * y + w.z * w.z);
  }
  /// wo.z >= 0.
  Vec3 sample_visible(const Vec3& wo, const Vec2& u) const { return sample_ggx_visible_normal(wo, alpha_, u); }

 private:
  static constexpr float kLeast = 1e-4f;  // keeps D and the densities within float range
  Vec2 alpha_{kLeast};
  bool smooth_ = true;
};

}  // namespace sightline
