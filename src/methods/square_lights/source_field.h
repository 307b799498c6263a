// A local light's patches as seen from points around it, as a table: a source radiance field.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/core/aligned.h"
#include "base/core/context.h"
#include "methods/square_lights/local_light.h"

namespace sightline::square_lights {

/// The sampling of the space around an emitter [Zhou2005]; radii in those of the emitter's bounding sphere.
inline constexpr int kSourceShells = 16, kSourceSize = 32;
inline constexpr float kInnerSource = 0.2f, kOuterSource = 15;
inline constexpr std::size_t kSourcePoints = std::size_t{kSourceShells} * 6 * kSourceSize * kSourceSize;

/// A patch from one sample point, 16 bytes.
struct PackedPatch {
  std::uint32_t direction = 0;  ///< octahedral, 16 bits each
  std::uint32_t radiance = 0;   ///< shared exponent, 9 bits a channel
  float radius = 0;             ///< half diagonal r
  float distance = 0;           ///< in radii of the emitter
};
static_assert(sizeof(PackedPatch) == 16);

/// A table over bytes that it does not own, in the emitter's own space: what LocalLight::lights_at says, whatever the emitter's shape. Only
/// for emitters of patches: a sphere's light is a formula.
class SourceField {
 public:
  SourceField() = default;
  SourceField(const Vec3& center, float radius, std::size_t count, std::span<const PackedPatch> table)
      : center_(center), radius_(radius), count_(count), table_(table) {}

  const Vec3& center() const { return center_; }
  float radius() const { return radius_; }
  std::size_t count() const { return count_; }
  /// Interpolates each patch between the eight sample points around `position`: where it is, and the area that it shows. Both hardly change
  /// with distance, so that positions between shells and beyond the last are nearly exact; within the first, what is seen there is taken.
  void lights_at(const Vec3& position, std::span<PatchLight> lights) const;

 private:
  Vec3 center_{0};
  float radius_ = 1;
  std::size_t count_ = 0;
  std::span<const PackedPatch> table_;  ///< [point][patch]
};

std::uint64_t source_field_bytes(const LocalLight& light);
/// Throws Error{interrupted} when cancelled; the same for any number of threads.
AlignedVector<PackedPatch> bake_source_field(const LocalLight& light, const Context& context);

}  // namespace sightline::square_lights
