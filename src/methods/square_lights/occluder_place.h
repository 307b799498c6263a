// Where a point stands about an occluder: what of its tables follows from the place alone.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/core/aligned.h"
#include "base/math/frame.h"

namespace sightline::square_lights {

/// The sampling of the space around an occluder [Zhou2005].
inline constexpr int kShells = 16, kShellSize = 32;
inline constexpr float kInnerShell = 0.4f, kOuterShell = 6;  ///< in bounding radii
/// Radius of shell k in bounding radii: logarithmic, so that the occluder's angle changes alike from each to the next.
float shell_radius(int k);
/// Radius on the disk of a bounding sphere seen from `rho` radii away: sqrt(1 - cos asin(1 / rho)); 1 within 1 radius.
float apparent_radius(float rho);

struct OccluderPlace {
  Vec3 normal{0, 0, -1};                 ///< unit, towards the centre
  float rho = 0;                         ///< distance from the centre in bounding radii
  float outline = 1;                     ///< apparent_radius(rho)
  float outline_cosine = 0;              ///< of half the angle of the bounding cone
  std::int32_t shell = 0;                ///< the inner one of the shells about it
  float between = 0;                     ///< 0 on that, 1 on the next
  std::int32_t face = 0;                 ///< of the cube of directions
  std::int32_t x = 0, y = 0;             ///< texel whose centre lies before the point on that face; -1: of the face beside it
  float fraction_x = 0, fraction_y = 0;  ///< how far beyond it, in texels
};
/// `away` is from the centre, in bounding radii. The scalar definition.
OccluderPlace occluder_place(const Vec3& away);

/// Where an occluder's bounding sphere stands for one receiver.
struct OccluderCone {
  Vec3 to{0};          ///< from the receiver to its centre
  float distance = 0;  ///< length of that
  float sine = 0, cosine = 0;
  bool inside = false;  ///< the receiver is in the sphere
};

/// Occluders as one receiver object meets them, structure of arrays.
struct OccluderLanes {
  std::array<AlignedVector<float>, 3> center;  ///< of bounding spheres, in the receiver's space
  AlignedVector<float> radius;                 ///< there
  std::array<AlignedVector<float>, 9> turn;    ///< of directions from there to the field's space, by rows
  std::size_t count = 0;

  void add(const Vec3& center, float radius, const Mat3& turn);
  /// Pads; to be called once all are added.
  void finish();
};

/// The places of one point about them.
struct OccluderPlaces {
  std::array<AlignedVector<float>, 3> to, normal;
  AlignedVector<float> distance, sine, cosine, rho, outline, outline_cosine, between, fraction_x, fraction_y;
  AlignedVector<std::int32_t> shell, face, x, y;

  OccluderCone cone(std::size_t i) const;
  OccluderPlace place(std::size_t i) const;
};
/// All places on the machine's best vectors: those of occluder_place() but for the last digits.
void occluder_places(const OccluderLanes& occluders, const Vec3& position, OccluderPlaces& places);

}  // namespace sightline::square_lights
