// The loop over square lights at one receiver, on the machine's best vectors: distances, what they leave visible, and the BRDF's share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/core/aligned.h"
#include "base/math/frame.h"
#include "base/math/vec.h"
#include "methods/square_lights/brdf_table.h"
#include "methods/square_lights/distance_table.h"
#include "methods/square_lights/occluder_field.h"
#include "methods/square_lights/square_light.h"

namespace sightline::square_lights {

/// Square lights in one space, structure of arrays: padded to kLanes by lights of radius and radiance 0.
struct LightSet {
  AlignedVector<float> x, y, z, r;
  AlignedVector<float> radiance;  ///< I, four floats a light (the last is 0)
  std::size_t count = 0;

  void clear();
  void reserve(std::size_t n);
  void add(const SquareLight& light);
  /// Pads; to be called once all are added.
  void finish();
  /// The same lights with centres turned by `rotation` (columns are images of the axes; need not be orthonormal: centres stay unit).
  void turned_from(const LightSet& other, const Mat3& rotation);
  SquareLight light(std::size_t i) const;
  LightLanes lanes() const { return {x, y, z, r, count}; }
};

/// Where a receiver's own distances come from: one table at a vertex, three of them between vertices, none for deformable objects.
struct ReceiverTables {
  int count = 0;
  const std::int8_t* table[3] = {};  ///< 64 readable bytes follow each
  Frame3 frame[3];
  float weight[3] = {};
};

/// Distance of every light that nothing hides.
inline constexpr float kNoOccluder = 1e3f;

/// D_self of every light. `gradient_x`, `gradient_y` (may be empty) receive its gradient on the disk of the first table's frame.
void self_distances(const ReceiverTables& tables, const LightSet& lights, std::span<float> distance, std::span<float> gradient_x,
                    std::span<float> gradient_y);

/// visible[i] *= covered fraction of light i at distance[i]; r_p = r times `plane_scale`. Gradients are read for Coverage::gradient alone.
void multiply_coverage(std::span<const float> distance, std::span<const float> gradient_x, std::span<const float> gradient_y,
                       const LightSet& lights, float plane_scale, Coverage coverage, std::span<float> visible);

/// Outgoing radiance: sum over lights of I (r / r_p)² visible x integral of the BRDF's table over the square. `lit` counts lights that
/// added anything.
Color shade(const Frame3& frame, const BrdfTable::Slices& slices, const LightSet& lights, std::span<const float> visible, float plane_scale,
            std::size_t& lit);

}  // namespace sightline::square_lights
