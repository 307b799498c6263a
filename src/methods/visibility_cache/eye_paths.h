// Whitted-style eye paths: mirrors and glass are followed, both branches of glass, until a surface that scatters.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/core/aligned.h"
#include "film/frame.h"
#include "film/view.h"
#include "methods/visibility_cache/eye_sample.h"
#include "trace/ray_batch.h"
#include "world/world.h"

namespace sightline {

struct EyePathOptions {
  /// Delta scatterings one after the other before an eye sample: mirrors, panes, boundaries of media. After one more a path still sees
  /// what shines, as the reference's paths do with as many bounces.
  int max_depth = 8;
  float least_weight = 0.01f;  ///< branches whose throughput falls below are dropped
  std::uint64_t seed = 0;
};

/// The tile's paths, block by block (4x4 pixels), sample by sample, 16 pixels a group, as Frame takes them (PixelBlock): path
/// (block * samples + sample) * 16 + lane.
struct TilePaths {
  std::size_t count = 0, samples = 0;
  AlignedVector<std::uint32_t> pixel, sample;
  AlignedVector<std::uint8_t> inside;  ///< 0: a lane that sticks out of the tile
  Vec3Batch emitted;                   ///< what the paths meet that shines: lights on geometry, background
};

/// Buffers of one thread.
class EyePaths {
 public:
  EyePaths(const World& world, const View& view, const EyePathOptions& options);
  ~EyePaths();
  EyePaths(const EyePaths&) = delete;
  EyePaths& operator=(const EyePaths&) = delete;

  /// Traces samples [range) of every pixel of the tile. `pass_samples` is the number of samples a pixel in the whole pass, which decides
  /// the density of paths. Fills `paths`, replaces `eye_samples`, in the order of paths, branches of a path after it in the order of their
  /// discovery: by depth, reflection before transmission. Camera rays, random numbers and materials are the reference's. Layers of the
  /// first hit (albedo, normal, position, depth, surface) go to `frame`; colour, direct and indirect are left to the caller.
  void trace(const Tile& tile, SampleRange range, std::uint32_t pass_samples, TilePaths& paths, std::vector<EyeSample>& eye_samples,
             Frame& frame, RayCounts& rays);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
