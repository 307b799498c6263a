// One sample of a picture: camera pass, refinement light by light, upsampling, and what they leave to the frame.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/core/context.h"
#include "film/frame.h"
#include "methods/fragments/area_light.h"
#include "methods/fragments/camera_pass.h"
#include "methods/fragments/compose.h"
#include "methods/fragments/edge_pass.h"
#include "methods/fragments/g_buffer.h"
#include "methods/fragments/light_signal.h"
#include "methods/fragments/nichols_refiner.h"
#include "methods/fragments/options.h"
#include "methods/fragments/picture_buffers.h"
#include "methods/fragments/refiner.h"
#include "methods/fragments/stage_map.h"
#include "methods/method.h"

namespace sightline {

/// Buffers of a whole picture, for one sample after the other.
class FragmentPicture {
 public:
  /// `buffers` may be those of an earlier picture of the same size.
  FragmentPicture(const RenderJob& job, const View& view, const FragmentsSettings& settings, const Context& context,
                  PictureBuffers&& buffers);

  /// How many samples will be asked for: for the progress that is reported.
  void expect(std::uint32_t samples);
  /// Adds picture sample `sample` to the frame.
  void render(std::uint32_t sample, Frame& frame, PassStatistics& statistics);
  /// Its buffers, once it is done.
  PictureBuffers release() { return std::move(buffers_); }

 private:
  void allocate();
  void begin_history();
  template <class Body>
  void for_tiles(const char* stage, std::size_t count, PassStatistics& statistics, Body body);
  template <class Body>
  void for_roots(const char* stage, PassStatistics& statistics, Body body);
  void trace_edges(std::uint32_t sample, CameraPass::Sampling sampling, PassStatistics& statistics);
  void render_light(const AreaLight& light, std::uint32_t sample, PassStatistics& statistics);
  void refine_borders(std::uint32_t sample, PassStatistics& statistics);
  void upsample_light(const AreaLight& light, std::uint32_t sample, PassStatistics& statistics);
  void write(std::uint32_t sample, Frame& frame, PassStatistics& statistics);
  void write_tile(const Tile& tile, std::uint32_t sample, Frame& frame) const;
  float map_value(std::size_t at, int channel) const;
  void write_layers(std::size_t at, std::uint32_t pixel, Frame& frame) const;

  double steps_ = 0, steps_done_ = 0;
  const RenderJob& job_;
  const View& view_;
  const Context& context_;
  FragmentsSettings settings_;
  FragmentOptions options_;
  std::vector<AreaLight> lights_;
  std::vector<LightPoints> points_;

  PictureBuffers buffers_;
  GBuffer& g_ = buffers_.g;
  Vec3Batch& radiance_ = buffers_.radiance;
  LightSignal& signal_ = buffers_.signal;
  std::array<AlignedVector<float>, 3>& pixels_ = buffers_.pixels;
  AlignedVector<float>& smoothed_ = buffers_.smoothed;
  std::vector<PriorShares> priors_;  ///< by light; empty: nothing is known
  StageMap map_;
  std::unique_ptr<EdgePass> edges_;
  std::vector<std::vector<Fragment>> fragments_;  ///< by root tile: what geometry left
  std::vector<TileProgress> progress_;            ///< by root tile: of the light at hand

  // By thread.
  std::vector<std::unique_ptr<CameraPass>> cameras_;
  std::vector<std::unique_ptr<Refiner>> refiners_;
  std::unique_ptr<NicholsRefiner> nichols_;  ///< of all threads
  std::vector<DiscontinuityPyramid> pyramids_;
  std::vector<Composer> composers_;
};

}  // namespace sightline
