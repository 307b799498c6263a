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
#include "methods/fragments/refiner.h"
#include "methods/fragments/stage_map.h"
#include "methods/method.h"

namespace sightline {

/// Buffers of a whole picture, for one sample after the other.
class FragmentPicture {
 public:
  FragmentPicture(const RenderJob& job, const View& view, const FragmentsSettings& settings, const Context& context);

  /// How many samples will be asked for: for the progress that is reported.
  void expect(std::uint32_t samples);
  /// Adds picture sample `sample` to the frame.
  void render(std::uint32_t sample, Frame& frame, PassStatistics& statistics);

 private:
  void allocate();
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

  GBuffer g_;
  Vec3Batch radiance_;
  LightSignal signal_;
  std::array<AlignedVector<float>, 3> pixels_;
  AlignedVector<float> smoothed_;
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
