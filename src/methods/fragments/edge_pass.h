// Anti-aliasing of geometric edges: more camera rays for pixels that show more than one surface.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "film/view.h"
#include "methods/fragments/camera_pass.h"
#include "methods/fragments/compose.h"
#include "methods/fragments/edges.h"
#include "methods/fragments/finest_test.h"
#include "methods/fragments/light_signal.h"
#include "methods/fragments/options.h"

namespace sightline {

/// The points that further camera rays of edge pixels hit. They have a GBuffer of their own, in which they follow each other root tile by
/// root tile, edge pixel by edge pixel; so the stages that light pixels light them as well.
///
/// In the order of a picture: begin(), find() for each root tile of the picture, gather(), trace() for each of tile_count() tiles of
/// points, light() for each light and tile of points, average() for each root tile of the picture. Calls for different tiles may run at the
/// same time.
class EdgePass {
 public:
  EdgePass(const RenderJob& job, const View& view, const FragmentOptions& options, const Context& context, CameraPass::Sampling sampling);

  void begin(const GBuffer& g);
  void find(const GBuffer& g, std::size_t root);
  void gather();
  std::size_t tile_count() const { return points_.root_count(); }
  void trace(const GBuffer& g, std::size_t tile, std::uint32_t sample, std::size_t thread, PassStatistics& statistics);

  /// A light as the picture's pixels have it: `pixels` is the signal after upsampling, by channel.
  struct Lit {
    const AreaLight& light;
    const LightSignal& signal;
    std::span<const float* const> pixels;
  };
  void light(const GBuffer& g, const Lit& lit, std::size_t tile, std::uint32_t sample, std::size_t thread, PassStatistics& statistics);
  /// The radiance of edge pixels becomes the mean over all of their points.
  void average(std::size_t root, Vec3Batch& radiance) const;

 private:
  static constexpr std::size_t kPerTile = static_cast<std::size_t>(kRootSize) * kRootSize;
  std::size_t points_per_pixel() const { return samples_ - 1; }
  std::size_t point_count() const { return pixels_.size() * points_per_pixel(); }
  std::size_t element_of(std::size_t point) const;
  std::uint32_t pixel_of(std::size_t point) const { return pixels_[point / points_per_pixel()]; }
  void place(const GBuffer& g, std::size_t first, std::size_t count, std::uint32_t sample, std::vector<CameraPlace>& places) const;

  const RenderJob& job_;
  const View& picture_;  ///< the view whose pixels these are
  View view_;            ///< the same with a filter that tells places apart
  const FragmentOptions& options_;
  std::uint64_t seed_;
  CameraPass::Sampling sampling_;
  std::size_t samples_;

  std::vector<std::vector<std::uint32_t>> found_;  ///< by root tile of the picture
  std::vector<std::size_t> begin_;                 ///< its first edge pixel in pixels_
  std::vector<std::uint32_t> pixels_;              ///< elements of the picture's GBuffer
  GBuffer points_;
  Vec3Batch radiance_;
  std::vector<std::uint32_t> neighbour_;  ///< by element: a pixel on the same surface
  std::array<AlignedVector<float>, 3> signal_;

  /// Buffers of one thread.
  struct Worker {
    std::unique_ptr<CameraPass> camera;
    std::unique_ptr<FinestTest> finest;
    Composer composer;
    std::vector<CameraPlace> places;
    std::vector<std::uint32_t> unknown;
    std::array<std::vector<float>, 3> values;
  };
  std::vector<Worker> workers_;
};

}  // namespace sightline
