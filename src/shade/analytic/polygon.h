// Irradiance from flat emitters of uniform radiance, without shadows: Lambert's formula for polygons [Lambert1760; Arvo1994].
//
// A form factor here is irradiance / (pi radiance), in [0, 1]: what a white Lambert surface would reflect of unit radiance. Polygons are
// flat and convex, of three corners or more; they emit on the side from which the corners run counter-clockwise, that of cross(corner 1 -
// corner 0, corner 2 - corner 0). What lies below the receiver's horizon is cut off exactly.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/core/aligned.h"
#include "base/math/vec.h"
#include "shade/lights/flat_light.h"

namespace sightline {

enum class EmitterSides { one, two };

/// Form factor at `position` with unit `normal`: the definition, in double precision. 0 for a point in the polygon's plane (to within a
/// millionth of the polygon's reach) and for polygons without area; never negative, never not-a-number.
double polygon_irradiance(std::span<const Vec3> polygon, const Vec3& position, const Vec3& normal, EmitterSides sides = EmitterSides::one);

/// The same for points [0, count), in vectors; writes padded(count) form factors. Within 1e-5 of the definition, relatively, plus 4e-6 of
/// what the emitter would give face to face, however far it is; ten times that at a hundredth of the polygon's reach from a corner.
/// (Coordinates far larger than distances lose what any float subtraction loses.)
void polygon_irradiance(std::span<const Vec3> polygon, const Vec3Batch& position, const Vec3Batch& normal, std::size_t count,
                        float* form_factor, EmitterSides sides = EmitterSides::one);

/// Corners for a disk: centre + a e1 + b e2 over the unit circle (an ellipse, if e1 and e2 differ). The polygon has the disk's area, so
/// that from afar the two are the same; with 64 corners form factors differ by less than 1e-4 from points that are at least a tenth of a
/// radius away from the rim, with 16 by less than 1e-3 from a third of a radius on.
inline constexpr std::size_t kDiskCorners = 64;
std::vector<Vec3> disk_polygon(const Vec3& centre, const Vec3& e1, const Vec3& e2, std::size_t corner_count = kDiskCorners);

/// Corners of a light of the table, in the order that makes its normal the emitting side.
std::vector<Vec3> flat_light_polygon(const FlatLight& light, const FlatEmitter& emitter, std::size_t disk_corners = kDiskCorners);

}  // namespace sightline
