// Shadow rays as visibility queries, for methods that sample lights and every --visibility but exact rays.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "methods/eye_footprint.h"
#include "methods/lambert_lanes.h"
#include "trace/ray_batch.h"
#include "visibility/visibility.h"
#include "world/world.h"

namespace sightline {

/// Shadow lanes in place, and what their queries are made of.
struct ShadowStage {
  ShadingPoints points;
  const HitBatch* hits;
  const std::uint32_t* point_id;      ///< by shading point: hash of pixel, sample and bounce
  const LightSampleBatch* light;      ///< light samples of all lanes
  const std::uint32_t* light_lane;    ///< of each shadow lane; null: its own number
  const std::uint32_t* sample_index;  ///< by light lane: which of its pixel's light samples
  const ShadowLanes* shadow;
  bool camera_hits;  ///< seen directly: how much surface a sample stands for is known
  bool coherent;     ///< lanes make coherent packets
};

/// Asks a Visibility what the lanes of a stage are worth. Of one thread.
class ShadowQueries {
 public:
  /// `samples_a_pixel` are those of a pass of the visibility, `light_samples` those of a shading point.
  ShadowQueries(const World& world, const View& view, Visibility& visibility, float samples_a_pixel, int light_samples);

  void begin_tile(std::uint32_t scope) { worker_->begin(scope); }
  /// A weight for each shadow lane, valid until the next call; 0 for lanes without a ray.
  std::span<const float> visible(const ShadowStage& stage, RayCounts& rays, VisibilityCounts& counts);

 private:
  std::uint32_t add_eye(const ShadowStage& stage, std::uint32_t point);
  std::uint32_t add_light(const ShadowStage& stage, std::uint32_t lane);
  void make_queries(const ShadowStage& stage);

  EyeFootprint footprint_;
  float light_samples_;
  std::unique_ptr<VisibilityWorker> worker_;
  QueryBatch queries_;
  AlignedVector<float> answers_, weights_;
  std::vector<std::uint32_t> lane_of_;                     ///< shadow lane of each query
  std::vector<std::uint32_t> end_of_light_, lights_used_;  ///< by entry of the light table: end of a light without extent in this batch
};

}  // namespace sightline
