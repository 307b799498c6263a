// Direct light by sampling: what Monte Carlo does at a pixel, with the numbers and the arithmetic of the reference's one-hit mode.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/core/aligned.h"
#include "base/math/frame.h"
#include "film/view.h"
#include "methods/lambert_lanes.h"
#include "methods/method.h"
#include "methods/shadow_queries.h"
#include "shade/bsdf.h"
#include "world/world.h"

namespace sightline {

/// Camera hits that are to be lit. One element a lane.
struct SampledPoints {
  const RayBatch* rays;
  const HitBatch* hits;
  const SurfaceBatch* surfaces;
  const std::vector<Bsdf>* bsdf;      ///< of lanes that are not plain
  const std::vector<Frame3>* frames;  ///< likewise
  const std::uint8_t* plain;
  const std::uint32_t* key;  ///< pixel_key of each
  std::uint32_t sample;      ///< index of the picture's sample
};

/// Buffers of one thread.
class SampledLight {
 public:
  /// `visibility` null: exact rays. `light_samples` >= 8.
  SampledLight(const World& world, const View& view, int light_samples, Visibility* visibility);

  void begin(std::uint32_t scope);
  /// radiance[i] += the light of all lights that point i reflects, for the lanes listed in `which`.
  void shade(const SampledPoints& points, std::span<const std::uint32_t> which, Vec3Batch& radiance, PassStatistics& statistics);

 private:
  static constexpr std::size_t kChunk = 512;
  struct Run {
    std::uint32_t point, first, count;
  };
  void flush(const SampledPoints& points, Vec3Batch& radiance, PassStatistics& statistics);
  void set_general(const SampledPoints& points, std::size_t point, std::size_t lane, std::size_t at);

  const World& world_;
  std::uint32_t light_samples_;
  std::unique_ptr<ShadowQueries> queries_;
  Vec3Batch throughput_, position_, normal_;
  AlignedVector<std::uint32_t> key_, index_;
  AlignedVector<float> u0_, u1_, u2_;
  LightSampleBatch light_;
  ShadowLanes shadow_;
  AlignedVector<std::uint8_t> occluded_;
  std::vector<Run> runs_;
  std::size_t lanes_ = 0;
  std::vector<std::uint32_t> point_id_, light_lane_;
};

}  // namespace sightline
