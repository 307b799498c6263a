// The area lights of a scene as this method asks them: one by one, or several folded into one.
#pragma once

#include <cstdint>
#include <vector>

#include "base/core/aligned.h"
#include "base/math/vec.h"
#include "shade/analytic/lobe_quadrature.h"
#include "shade/analytic/polygon.h"
#include "world/world.h"

namespace sightline {

/// One flat light, or a group of lights chosen by power whose shadows are refined together.
struct AreaLight {
  struct Member {
    std::uint32_t entry = 0;    ///< of the LightTable
    float probability = 1;      ///< of being chosen within the group
    std::vector<Vec3> polygon;  ///< disks are cut into polygons of the same area
    FlatSurface surface;        ///< the same, not cut
    Vec3 normal{0, 0, 1};
    EmitterSides sides = EmitterSides::one;
    Color radiance{0};
  };
  std::vector<Member> members;
  std::vector<float> cumulative;  ///< of the probabilities, last 1
  /// Its light without shadows has a closed form worth using: uniform radiance, few polygons.
  bool analytic = true;

  /// Which member `u` in [0, 1) chooses; `u` is stretched back to [0, 1).
  std::size_t pick(float& u) const;
  /// No member sends light to a point with this normal: all below its horizon, or turned away.
  bool out_of_reach(const Vec3& position, const Vec3& normal) const;
  /// About how much of the half-space above the surface its members fill, in steradians; from afar.
  float solid_angle(const Vec3& position, const Vec3& normal) const;
  /// Every point of it lies above the plane.
  bool above(const Vec3& position, const Vec3& normal) const;
};

/// Every flat light with power, at most `limit` of them; where there are more, neighbours are folded together.
std::vector<AreaLight> area_lights(const LightTable& lights, std::size_t limit);

/// Where within its stratum a point lies.
enum class PointJitter : std::uint8_t {
  hash,  ///< anywhere, in each set anew
  blue,  ///< one pattern that sets (0 ... 15) + 16 (0 ... 15) move along both axes of the strata: like numbers, like errors
};

/// Sets of stratified points on an area light. All probes of a fragment share one set, so that bit k of their answers means the same point;
/// fragments take sets by their place. Point k of set s is element s * count + k.
struct LightPoints {
  static constexpr std::uint32_t kShifts = 16, kSets = kShifts * kShifts;
  PointJitter jitter = PointJitter::hash;
  std::uint32_t count = 16;  ///< 16, 32 or 64: strata of 4x4, 8x4, 8x8
  Vec3Batch point, normal, radiance;
  AlignedVector<float> error;      ///< of `point`, per component
  AlignedVector<float> area;       ///< surface that the point stands for: 1 / (count * density)
  AlignedVector<float> two_sided;  ///< 1 or 0
};
LightPoints light_points(const LightTable& lights, const AreaLight& light, std::uint32_t count, std::uint64_t seed,
                         PointJitter jitter = PointJitter::hash);

}  // namespace sightline
