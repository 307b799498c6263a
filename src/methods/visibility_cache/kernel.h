// One tile of the visibility-cache method: eye points, unoccluded contributions, batches of visibility queries, sums.
#pragma once

#include <memory>
#include <vector>

#include "methods/method.h"
#include "methods/visibility_cache/contributions.h"
#include "methods/visibility_cache/eye_absorption.h"
#include "methods/visibility_cache/eye_paths.h"
#include "methods/visibility_cache/settings.h"
#include "methods/visibility_cache/virtual_point_lights.h"

namespace sightline {

/// What all tiles of a pass share.
struct EyePass {
  std::uint32_t samples = 1;  ///< a pixel, in the whole pass
  int light_samples = 16;
  VirtualPointLights virtual_lights;
  std::vector<std::uint32_t> general_virtual_lights;  ///< those that are no Lamberts
};

/// What all passes of a picture share.
struct EyeLights {
  explicit EyeLights(const LightTable& table);
  LightSubset area, environment;
  std::vector<std::uint32_t> punctual;  ///< entries, all of which are asked
  std::vector<float> area_of_entry;     ///< surface over the probability of the entry's choice, for entries of `area`
};

/// Buffers of one thread.
class EyeKernel {
 public:
  EyeKernel(const World& world, const View& view, Visibility& visibility, const VisibilityCacheSettings& settings, const Context& context,
            const EyeLights& lights);

  /// Adds samples [range) of every pixel of the tile to the frame. Throws Error{interrupted} when cancelled, and then has added nothing.
  void render_tile(const Tile& tile, SampleRange range, const EyePass& pass, Frame& frame, PassStatistics& statistics);

 private:
  using EyeRange = std::pair<std::size_t, std::size_t>;  ///< into order_

  void put_in_order(const Tile& tile);
  void set_eye_ends(EyeRange chunk);
  const EyeSample& eye(std::size_t k) const { return eye_samples_[order_[k]]; }
  /// Calls shade(chunk) for runs of eye samples with `per_eye` light samples each.
  template <class Shade>
  void in_chunks(std::size_t per_eye, Shade shade);
  void shade_punctual(EyeRange chunk, PassStatistics& statistics);
  void shade_area(EyeRange chunk, const EyePass& pass, PassStatistics& statistics);
  void shade_environment(EyeRange chunk, const EyePass& pass, PassStatistics& statistics);
  template <class CellOf>
  void add_bsdf_sample(const EyeSample& e, std::uint32_t eye_index, float u_lobe, const Vec2& u, const SampleWeights& weights,
                       std::size_t end, CellOf cell_of);
  int environment_bsdf_samples(const EyePass& pass) const;
  void shade_virtual(EyeRange chunk, const EyePass& pass, PassStatistics& statistics);
  void draw_environment(const Tile& tile, SampleRange range, const EyePass& pass);
  void draw_numbers(EyeRange chunk, std::size_t per_eye, std::uint32_t first_pair);
  void set_virtual_ends(const VirtualPointLights& lights);
  void ask(Vec3Batch& radiance, bool shared_lights, PassStatistics& statistics);
  void compute_importance();
  void ask_by_light(PassStatistics& statistics);
  void write(Frame& frame);

  const World& world_;
  VisibilityCacheSettings settings_;
  std::uint64_t seed_;
  const Context& context_;
  bool may_stop_ = false;  ///< inside a tile: nothing of it is in the frame yet
  const EyeLights& lights_;
  bool spatial_order_ = false;  ///< every query of the tile is a ray: neighbours side by side trace fastest
  float first_segment_;         ///< C_E²
  EyePaths eye_paths_;
  EyeAbsorption absorption_;
  std::unique_ptr<VisibilityWorker> worker_;

  TilePaths paths_;
  std::vector<EyeSample> eye_samples_;
  std::vector<std::uint32_t> order_, rank_, bucket_;
  IVec2 ranked_size_{0};
  Vec3Batch direct_, indirect_;  ///< by path

  // One batch of queries.
  QueryBatch queries_;
  Contributions contributions_;
  AlignedVector<float> weights_, sorted_weights_;
  std::vector<std::uint32_t> light_begin_, place_;  ///< sorting queries by light
  std::vector<std::size_t> chunk_slot_;
  LightSampleBatch light_;
  SentRadiance sent_;
  LightSampleBatch sky_;  ///< directions of the environment that the tile's eye samples choose from
  std::size_t sky_size_ = 0;
  Vec3Batch position_, normal_;
  AlignedVector<std::uint32_t> key_, index_, entry_;
  AlignedVector<float> u0_, u1_, u2_;
};

}  // namespace sightline
