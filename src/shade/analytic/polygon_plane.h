// What the scalar and the vector form of the polygon integrals share.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/math/frame.h"
#include "shade/analytic/polygon.h"

namespace sightline {

/// Where a polygon lies.
struct PolygonPlane {
  Vec3 centre{0};          ///< mean of the corners
  float reach = 0;         ///< distance of the farthest corner from it
  Vec3 normal{0};          ///< unit, of the emitting side; 0 for polygons without area
  float least_height = 0;  ///< nearer than this to the plane a point counts as in it

  PolygonPlane() = default;
  explicit PolygonPlane(std::span<const Vec3> polygon);
  /// For a point at a signed height above the plane.
  bool emits_towards(double height, EmitterSides sides) const {
    return normal != Vec3(0) && (sides == EmitterSides::two ? std::fabs(height) : height) > least_height;
  }
};

/// The corners measured from the plane's centre, rounded once.
std::vector<Vec3> polygon_offsets(std::span<const Vec3> polygon, const PolygonPlane& plane);

/// angle / sin(angle) - 1 = x sum c_i x^i, x = 1 - cos(angle) in [0, 1], to within 1.1e-7 of itself: interpolation of (asin / sqrt) at the
/// nodes of the ninth Chebyshev polynomial.
inline constexpr std::array<float, 9> kAngleSeries{0.333333364f,   0.133328436f,  0.0572714832f,  0.0241140989f, 0.0178409227f,
                                                   -0.0116120732f, 0.0282145884f, -0.0199459573f, 0.00825140589f};

/// Integral of z / pi over the directions that a polygon covers with z >= 0, in coordinates around the receiver: positive where its corners
/// run counter-clockwise as the receiver sees them. A `transform` of what is left above the horizon comes before the integral.
double horizon_form_factor(std::span<const Vec3d> local_polygon, const glm::dmat3& transform = glm::dmat3(1));

/// Corners in the frame's coordinates around `position`.
std::vector<Vec3d> local_polygon(std::span<const Vec3> polygon, const Vec3& position, const Frame3& frame);

}  // namespace sightline
