// Vector code for choosing lights and sampling flat and punctual ones. Bit for bit what alias_table.h, flat_light.h and punctual_light.h
// define, on every target: the same operations in the same order, no fused multiply-add.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/sample/alias_table.h"
#include "shade/light_table.h"
#include "shade/lights/flat_light.h"
#include "shade/lights/punctual_light.h"

namespace sightline {

/// Inputs of a run of lanes. `light` (null: all lanes take `single`) are entries of the table, `selection` (null: `single_selection`) the
/// probabilities of their choice.
struct LightLanes {
  const float *x, *y, *z;
  const float *u0, *u1;
  const std::uint32_t* light;
  const float* selection;
  std::uint32_t single;
  float single_selection;
  std::size_t count;
};

/// Each function handles as many lanes as fill whole vectors and returns their number; the rest is for the scalar code.
std::size_t pick_lights(const AliasTable& table, const float* u, std::size_t count, std::uint32_t* light, float* probability);
/// Rectangles and triangles, without textures. Entry i is lights[i]. Writes samples from index `first` on.
std::size_t sample_flat_lanes(const LightLanes& lanes, const FlatLight* lights, const FlatEmitter* emitters, LightSampleBatch& samples,
                              std::size_t first);
/// Points and directional lights; entry i is lights[i - first_entry].
std::size_t sample_punctual_lanes(const LightLanes& lanes, const PunctualLight* lights, std::uint32_t first_entry,
                                  LightSampleBatch& samples, std::size_t first);

/// More entries than 31-bit word offsets can address are left to the scalar code.
inline constexpr std::size_t kMaxVectorFlats = std::size_t{1} << 27;

}  // namespace sightline
