// Watertight ray-triangle test [Woop2013].
#pragma once

#include <cmath>
#include <optional>
#include <utility>

#include "base/math/vec.h"

namespace sightline {

/// A ray made ready for the test: axes permuted so that z is the direction's largest, and sheared onto it.
class WoopRay {
 public:
  WoopRay(const Vec3& origin, const Vec3& direction) : origin_(origin) {
    const Vec3 size = glm::abs(direction);
    kz_ = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    kx_ = (kz_ + 1) % 3;
    ky_ = (kx_ + 1) % 3;
    if (direction[kz_] < 0) std::swap(kx_, ky_);  // keeps the winding
    shear_ = Vec3{direction[kx_], direction[ky_], 1.f} / direction[kz_];
  }

  struct Hit {
    float t, u, v;
  };

  /// The hit in [t_near, t_far], from either side; edges and corners count as inside, so neighbours leave no gap.
  std::optional<Hit> intersect(const Vec3& v0, const Vec3& v1, const Vec3& v2, float t_near, float t_far) const {
    const Vec3 a = v0 - origin_, b = v1 - origin_, c = v2 - origin_;
    const float ax = a[kx_] - shear_.x * a[kz_], ay = a[ky_] - shear_.y * a[kz_];
    const float bx = b[kx_] - shear_.x * b[kz_], by = b[ky_] - shear_.y * b[kz_];
    const float cx = c[kx_] - shear_.x * c[kz_], cy = c[ky_] - shear_.y * c[kz_];
    float e0 = cx * by - cy * bx, e1 = ax * cy - ay * cx, e2 = bx * ay - by * ax;
    // Exactly on an edge in single precision: products of floats are exact in double, so the sign is too.
    if (e0 == 0 || e1 == 0 || e2 == 0) {
      e0 = static_cast<float>(double(cx) * double(by) - double(cy) * double(bx));
      e1 = static_cast<float>(double(ax) * double(cy) - double(ay) * double(cx));
      e2 = static_cast<float>(double(bx) * double(ay) - double(by) * double(ax));
    }
    if ((e0 < 0 || e1 < 0 || e2 < 0) && (e0 > 0 || e1 > 0 || e2 > 0)) return std::nullopt;
    const float determinant = e0 + e1 + e2;
    if (determinant == 0) return std::nullopt;
    const float scaled_t = shear_.z * (e0 * a[kz_] + e1 * b[kz_] + e2 * c[kz_]);
    const float t = scaled_t / determinant;
    if (!(t >= t_near && t <= t_far)) return std::nullopt;
    return Hit{t, e1 / determinant, e2 / determinant};
  }

 private:
  Vec3 origin_, shear_{0};
  int kx_ = 0, ky_ = 1, kz_ = 2;
};

}  // namespace sightline
