// The square light that stands best for a region of the environment.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "base/math/vec.h"
#include "methods/square_lights/square_light.h"

namespace sightline::square_lights {

/// Coordinates about a square's centre in which areas are solid angles: distance 2 sin(angle / 2). `local` is unit, z towards the centre.
inline Vec2 lambert_azimuthal(const Vec3& local) {
  const float k = std::sqrt(2 / std::max(1 + local.z, 1e-12f));
  return {local.x * k, local.y * k};
}

struct SquareFit {
  SquareLight light;
  float solid_angle = 0;  ///< |S| of the region
  float error = 0;        ///< J
};

/// Collects a region's points, then fits. A fitter is scratch memory: one a thread, used for many regions.
///
/// J(c, r) = |S| (∫_S L² - (Λ / r²) · mean over turns of ∫_{S ∩ O} L + Λ² / (2 r²)), Λ = ∫_S L, is the paper's Eq. 7 multiplied out for
/// I = Λ / (2 r²), summed over channels. The four turns are 0, π/8, π/4 and 3π/8.
///
/// A point stands for a small square of its solid angle: it enters a light's square not at once but over its own width, so that J
/// is continuous.
class SquareFitter {
 public:
  void clear();
  void add(const Vec3& direction, float solid_angle, const Color& radiance);

  /// Minimises J over c and r, starting at the centroid of the light and at `starts` (unit). For one value of c all r are tried at once.
  SquareFit fit(std::span<const Vec3> starts, bool area_penalty);
  /// J of a given centre and half diagonal.
  double error(const Vec3& center, float radius, bool area_penalty);
  /// The light of a given centre and half diagonal, which keeps the region's flux.
  SquareLight light(const Vec3& center, float radius) const;
  double solid_angle() const { return solid_angle_; }

 private:
  static constexpr int kTurns = 4;
  struct Best {
    double value;  // J / |S|
    float half;    // of the edge: r / sqrt(2)
  };
  void finish();
  void project(const Vec3& center);
  double error_at(double covered, double half) const;
  double covered(float half) const;
  Best best_half(const Vec3& center);
  Vec3 centroid() const;

  struct Point {
    Vec3 direction;
    float solid_angle;
    Color radiance;
    float width, weight;  // edge of its square; Λ·L dω
  };
  std::vector<Point> points_;
  std::vector<float> distance_;  // [turn][point]: greater of |x'|, |y'| about the centre in question
  std::vector<double> covered_at_;
  bool finished_ = false;
  double solid_angle_ = 0, squared_ = 0;
  glm::dvec3 flux_{0};
};

}  // namespace sightline::square_lights
