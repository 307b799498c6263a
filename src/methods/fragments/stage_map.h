// Maps of the stages: what the setting `show` puts in the place of the picture.
#pragma once

#include <cstdint>

#include "base/core/aligned.h"
#include "methods/fragments/fragment.h"
#include "methods/fragments/g_buffer.h"
#include "methods/fragments/options.h"
#include "methods/fragments/pyramid.h"
#include "methods/fragments/settings.h"

namespace sightline {

/// Written while a picture is made, each root tile by one thread at a time; laid out as the GBuffer. Without a map the stages count
/// nothing.
class StageMap {
 public:
  using Show = FragmentsSettings::Show;
  explicit StageMap(Show show) : show_(show) {}

  bool wants_rays() const { return show_ == Show::rays; }
  bool wants_gradients() const { return show_ == Show::gradients; }
  bool wants_curvature() const { return show_ == Show::curvature; }
  /// Whether the tests of fragments have to be told about it.
  bool watches_tests() const { return wants_rays() || wants_gradients(); }

  /// Nothing seen yet.
  void begin(const GBuffer& g);
  /// `rays` were spent on a fragment: its pixels in the picture share them. In units of the 64 rays that Monte Carlo would spend a pixel.
  void add_rays(const GBuffer& g, const Fragment& f, std::uint32_t rays);
  void add_rays(std::size_t at, std::uint32_t rays) { first_[at] += static_cast<float>(rays) / kRaysPerUnit; }
  /// The share of the light's points by which a fragment's parts differ; a later test replaces an earlier one.
  void set_gradient(const GBuffer& g, const Fragment& f, float gradient);
  /// Change of the normal and of depth from each pixel to its neighbours, in units of the thresholds that split fragments.
  void set_geometry(const GBuffer& g, const RootTile& tile, const DiscontinuityPyramid& pyramid, const GeometryOptions& options);

  /// The map's value: red for everything, green for the change of depth as well.
  float first(std::size_t at) const { return first_[at]; }
  float second(std::size_t at) const { return wants_curvature() ? second_[at] : first_[at]; }
  float third(std::size_t at) const { return wants_curvature() ? 0.f : first_[at]; }

 private:
  static constexpr float kRaysPerUnit = 64;
  Show show_;
  AlignedVector<float> first_, second_;
};

/// The steepest of the four gradients between quadrants that share an edge, as a share of the light's points.
float steepest_gradient(const ProbeMasks& masks, std::uint32_t points);

}  // namespace sightline
