// What light samples and virtual lights would bring to eye points whose BSDF has lobes (shade/surface_lobes.h), 16 at a time.
//
// The scalar definition, for every BSDF, is in contributions.cpp; tests compare the two.
#pragma once

#include <cstdint>
#include <span>

#include "methods/visibility_cache/eye_sample.h"
#include "methods/visibility_cache/virtual_point_lights.h"
#include "shade/light_table.h"
#include "shade/surface_lobes.h"

namespace sightline {

/// Non-zero unoccluded contributions, side by side: one query each.
struct Contributions {
  Vec3Batch color;
  AlignedVector<std::uint32_t> eye;    ///< index of the eye sample in its chunk
  AlignedVector<std::uint32_t> light;  ///< lane of the light samples, or index of the virtual light
  std::size_t size = 0;

  void resize(std::size_t capacity) {
    // A compressed store may write a whole vector at the last element.
    color.resize(capacity + kLanes);
    eye.resize(padded(capacity + kLanes)), light.resize(padded(capacity + kLanes));
    size = 0;
  }
};

/// How light samples are weighted.
struct SampleWeights {
  float scale = 1;      ///< 1 / number of samples; 1 for lights that are all asked
  float mis_light = 0;  ///< samples drawn from the lights: with mis_bsdf, balance heuristic against BSDF sampling
  float mis_bsdf = 0;   ///< samples drawn from the BSDF; 0 = no other technique
};

/// Appends the light samples [first, first + count) of `lights` at `eye`, whose BSDF has `lobes` seen from wo. Up to kLanes - 1 lanes
/// behind the last are read, and must be there. Lights are numbered from `number` on.
void append_samples(const EyeSample& eye, const SurfaceLobes& lobes, std::uint32_t eye_index, const LightSampleBatch& lights,
                    std::size_t first, std::size_t count, std::uint32_t number, const SampleWeights& weights, Contributions& out);

/// Appends the virtual lights that are Lamberts at `eye`, whose BSDF has `lobes`.
void append_virtual_lights(const EyeSample& eye, const SurfaceLobes& lobes, std::uint32_t eye_index, const VirtualPointLights& lights,
                           Contributions& out);
/// The same for the lights listed in `which`, but as if each sent radiance 1 on both of its sides, and with their places in that list for
/// numbers.
void append_unit_lights(const EyeSample& eye, const SurfaceLobes& lobes, std::uint32_t eye_index, const VirtualPointLights& lights,
                        std::span<const std::uint32_t> which, Contributions& out);

/// Sum of weight[i] * color[i] over [begin, end).
Color weighted_sum(const Contributions& contributions, const float* weights, std::size_t begin, std::size_t end);

}  // namespace sightline
