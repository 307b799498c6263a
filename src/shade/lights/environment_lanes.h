// Radiance of an environment from many directions on the machine's best vectors.
#pragma once

#include <cstddef>

#include "base/core/aligned.h"
#include "base/math/vec.h"
#include "scene/light.h"

namespace sightline {

/// What EnvironmentLight::radiance() reads, as the lanes want it.
struct EnvironmentPicture {
  const float* values = nullptr;  ///< interleaved floats
  int width = 0, height = 0, channels = 0;
  EnvironmentMapping mapping = EnvironmentMapping::latlong;
  Mat3 local_from_world{1};
  Color scale{1};

  /// All mappings but the octahedral one, as long as their values can be counted with 31 bits.
  bool has_lanes() const;
};

/// Of `count` unit directions in arrays padded to kLanes; grows `radiance` if needed. Of cubes bit for bit what single look-ups give; of
/// the others the angles' last digits may differ.
void environment_radiance(const EnvironmentPicture& picture, const Vec3Batch& direction, std::size_t count, Vec3Batch& radiance);

}  // namespace sightline
