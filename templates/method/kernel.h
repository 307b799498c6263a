// The mathematics of the example method for one tile: no threads, no files.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/core/aligned.h"
#include "methods/example/settings.h"
#include "methods/method.h"

namespace sightline {

/// Buffers of one thread. Everything runs over batches of camera rays that stay in the second-level cache.
class ExampleKernel {
 public:
  ExampleKernel(const World& world, const View& view, Visibility& visibility, const ExampleSettings& settings, std::uint64_t seed);

  /// Adds `samples` of every pixel of `tile` to the frame.
  void render_tile(const Tile& tile, SampleRange samples, Frame& frame, PassStatistics& statistics);

 private:
  void trace_camera_rays(std::uint32_t sample, PassStatistics& statistics);
  void gather_queries(std::uint32_t sample);
  void add_results(std::uint32_t sample, Frame& frame, PassStatistics& statistics);
  void random_numbers(std::uint32_t sample, std::uint32_t pair, AlignedVector<float>& u, AlignedVector<float>& v);

  const World& world_;
  const View& view_;
  const ExampleSettings& settings_;
  std::uint64_t seed_;

  // One element a pixel of the tile.
  AlignedVector<std::uint32_t> pixel_, key_, index_;
  AlignedVector<float> u0_, u1_, u2_, u3_;
  RayBatch rays_;
  HitBatch hits_;
  SurfaceBatch surfaces_;
  std::vector<Color> radiance_;

  // One element a light sample that would arrive if nothing were in its way.
  std::unique_ptr<VisibilityWorker> visibility_;
  QueryBatch queries_;
  AlignedVector<float> weights_;
  std::vector<Color> contributions_;
};

}  // namespace sightline
