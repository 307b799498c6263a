// The vector path of the kernel: shading points that are plain Lambert surfaces, 16 at a time.
//
// The scalar definition is Lambert (src/shade/lambert.h) in the frame rules of kernel.cpp; tests compare the two.
#pragma once

#include <cstddef>
#include <cstdint>

#include "shade/light_table.h"
#include "trace/ray_batch.h"
#include "world/surface.h"

namespace sightline {

/// Surfaces hit by rays with their path throughput: what direct light and scattering need of a batch.
struct ShadingPoints {
  const RayBatch* rays;  ///< that hit; wo = -direction
  const SurfaceBatch* surfaces;
  const Vec3Batch* throughput;
};

/// Shadow rays with the radiance they carry if nothing is in between. Either compacted, so that only non-zero contributions have a lane; or
/// in place, where a lane's position depends on its point and sample alone and the others are inactive rays (t_far < 0). Coherent packets
/// are only made of rays in place: their answers at ties depend on the company a ray keeps, and must not depend on how samples are split
/// into passes.
struct ShadowLanes {
  RayBatch rays;
  Vec3Batch contribution;
  AlignedVector<std::uint32_t> point;  ///< index into ShadingPoints
  std::size_t count = 0;
  bool in_place = false;
  void resize(std::size_t capacity);
};

struct DirectLightOptions {
  float samples = 1;  ///< light samples a point
  bool mis = true;    ///< weight against BSDF sampling where rays find the light
};

/// Appends to `out` the contributions of `count` light samples that all belong to point `point`, lane 0 being `light`'s lane `first`.
void append_direct_light(const ShadingPoints& points, std::uint32_t point, const LightSampleBatch& light, std::size_t first,
                         std::size_t count, const DirectLightOptions& options, ShadowLanes& out);
/// The same for one light sample a point: lane i belongs to point first_point + i. `active` (1 byte a point) masks points out.
void append_direct_light_each(const ShadingPoints& points, std::uint32_t first_point, const LightSampleBatch& light, std::size_t count,
                              const std::uint8_t* active, const DirectLightOptions& options, ShadowLanes& out);

/// radiance[i] += contribution[i] where occluded[i] is 0, for lanes [0, count): lanes in place, one sample a point.
void add_visible(const ShadowLanes& lanes, const std::uint8_t* occluded, std::size_t count, Vec3Batch& radiance);

/// Cosine-weighted directions about the shading normals: unit wi and pdf for lanes [0, count); pdf 0 where the direction crosses the
/// geometric surface. `u`, `v` in [0,1).
void sample_lambert(const ShadingPoints& points, const float* u, const float* v, std::size_t count, Vec3Batch& wi, float* pdf);

}  // namespace sightline
