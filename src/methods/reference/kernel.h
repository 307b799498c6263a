// Path tracing of one tile in waves: every stage runs over a batch of paths before the next begins.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/core/aligned.h"
#include "film/frame.h"
#include "film/view.h"
#include "methods/lambert_lanes.h"
#include "methods/media.h"
#include "methods/method.h"
#include "methods/shadow_queries.h"
#include "methods/shadow_terminator.h"
#include "shade/bsdf.h"
#include "world/world.h"

namespace sightline {

struct KernelOptions {
  int light_samples = 1;
  int max_bounces = 8;
  int roulette_start = 4;
  bool one_hit = false;  ///< light sampling only, no MIS
  std::uint64_t seed = 0;
  Visibility* visibility = nullptr;  ///< answers shadow rays; null: exact rays
  std::uint32_t samples_a_pass = 1;  ///< samples a pixel in one pass of `visibility`
};

/// State of one thread's batch of paths. A path is a slot (0 … path count); per-bounce arrays are compacted to the living ones, `slot`
/// telling whose they are.
class PathKernel {
 public:
  PathKernel(const World& world, const View& view, const KernelOptions& options);

  /// Adds samples of every pixel of the tile to the frame. No threads, no files.
  void render_tile(const Tile& tile, SampleRange samples, Frame& frame, PassStatistics& statistics);

 private:
  static constexpr std::size_t kBatch = 1024;
  /// Light samples worked off at a time: what the light batch and the shadow rays need stays in the L2 cache.
  static constexpr std::size_t kLightChunk = 512;

  void start_paths(const Tile& tile, std::span<const IVec2> blocks, SampleRange samples);
  void finish_paths(Frame& frame);
  void trace(std::uint32_t bounce);
  void travel();
  void add_emission(std::uint32_t bounce);
  void evaluate_materials(std::uint32_t bounce);
  void sample_lights(std::uint32_t bounce);
  void sample_lights_once(std::uint32_t bounce);
  void sample_lights_often(std::uint32_t bounce);
  void gather_keys(std::uint32_t bounce);
  void draw_light_samples(std::uint32_t bounce, std::size_t count, const Vec3Batch& positions, const Vec3Batch& normals);
  bool coherent_shadows(std::uint32_t bounce) const;
  void set_inactive(std::size_t at, std::size_t point);
  template <class Weight>
  void absorb_shadows(std::span<const Weight> weights, Weight dark);
  bool set_general(std::size_t point, std::size_t lane, std::size_t at);
  void trace_shadows(std::uint32_t bounce);
  void ask_visibility(std::uint32_t bounce);
  void scatter(std::uint32_t bounce);
  void write_aovs(Frame& frame);
  void add_radiance(std::uint32_t slot, bool direct, const Color& value);

  const World& world_;
  const View& view_;
  KernelOptions options_;
  bool bsdf_sampling_finds_lights_;
  MediumRays medium_rays_;
  MediumId camera_medium_;
  ShadowTerminator terminator_;

  // One element a path, for its whole life.
  std::size_t path_count_ = 0, samples_a_block_ = 0;
  AlignedVector<std::uint32_t> pixel_, sample_, key_;
  AlignedVector<std::uint8_t> in_picture_;  ///< 0: fills up a block that sticks out of the tile
  Vec3Batch direct_, indirect_;             ///< radiance so far

  // One element a living path, compacted after each bounce.
  std::size_t alive_ = 0;
  AlignedVector<std::uint32_t> slot_;
  Vec3Batch throughput_;
  std::vector<float> bsdf_pdf_;                   ///< of the ray being traced; < 0 after the camera or a delta bounce
  std::vector<Vec3> previous_, previous_normal_;  ///< where the ray left
  std::vector<MediumId> medium_;
  std::vector<float> cone_width_, cone_spread_;
  RayBatch rays_;
  HitBatch hits_;
  SurfaceBatch surfaces_;

  // One element a shading point of this bounce (index = compacted index).
  std::vector<Bsdf> bsdf_;
  std::vector<Frame3> frame_;
  AlignedVector<std::uint8_t> shaded_;  ///< 1: a surface with a BSDF
  bool all_plain_ = false;              ///< no shaded point needs its bsdf_ and frame_

  // Scratch of the stages.
  AlignedVector<std::uint32_t> scratch_key_, scratch_index_;
  AlignedVector<float> u0_, u1_, u2_, u3_, pdf_;
  AlignedVector<std::uint8_t> plain_;  ///< shaded and plain: the vector path
  /// Lanes of a light batch that belong to one point.
  struct Run {
    std::uint32_t point, first, count;
  };
  std::vector<Run> runs_;
  Vec3Batch light_position_, light_normal_, wi_;
  LightSampleBatch light_;
  ShadowLanes shadow_;
  AlignedVector<std::uint8_t> occluded_;
  RayCounts counts_;
  RayBatch absorbed_;  ///< shadow rays that arrive, in a scene with media
  std::vector<MediumId> absorbed_medium_;
  std::vector<std::uint32_t> absorbed_lane_;

  // With a visibility other than exact rays.
  std::unique_ptr<ShadowQueries> queries_;
  VisibilityCounts visibility_counts_;
  std::vector<std::uint32_t> point_id_, light_lane_;
};

}  // namespace sightline
