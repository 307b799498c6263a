// Unoccluded contributions of lights to eye points of any material: what visibility is asked about.
#pragma once

#include <cstdint>
#include <span>

#include "methods/visibility_cache/eye_lanes.h"
#include "methods/visibility_cache/vpl_radiance.h"

namespace sightline {

/// Lane `lane` of light samples at `eye`: f cos L weight; 0 where nothing arrives or the two normals disagree. The scalar definition.
Color sample_contribution(const EyeSample& eye, const LightSampleBatch& lights, std::size_t lane, const SampleWeights& weights);
/// Virtual light `j` at `eye`, with the geometry term clamped. The scalar definition.
Color virtual_light_contribution(const EyeSample& eye, const VirtualPointLights& lights, std::size_t j);

/// Appends light samples [first, first + count) at `eye`, numbered from `number` on, in vectors where the material allows.
void add_samples(const EyeSample& eye, std::uint32_t eye_index, const LightSampleBatch& lights, std::size_t first, std::size_t count,
                 std::uint32_t number, const SampleWeights& weights, Contributions& out);
/// Appends all virtual lights at `eye`; `general` lists those that are no Lamberts, and `sent` has what they send, `eye` being the point
/// `eye_index` there.
void add_virtual_lights(const EyeSample& eye, std::uint32_t eye_index, const VirtualPointLights& lights,
                        std::span<const std::uint32_t> general, const SentRadiance& sent, Contributions& out);

}  // namespace sightline
