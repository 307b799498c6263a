// Waves of fragments over one root tile and one light: test, classify, split, until every fragment is stable or a pixel.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "methods/fragments/area_light.h"
#include "methods/fragments/finest_test.h"
#include "methods/fragments/fragment.h"
#include "methods/fragments/g_buffer.h"
#include "methods/fragments/history.h"
#include "methods/fragments/light_signal.h"
#include "methods/fragments/options.h"
#include "methods/fragments/probe_test.h"
#include "methods/fragments/reach.h"
#include "methods/fragments/stage_map.h"
#include "methods/fragments/unshadowed.h"

namespace sightline {

/// Fragments and rays by what they were for, in the paper's terms.
struct RefinementCounts {
  std::uint64_t fragments = 0;  ///< stable ones and pixels
  std::uint64_t finest = 0;     ///< of those, pixels of level 0
  std::uint64_t test_rays = 0, confirm_rays = 0, finest_rays = 0, penumbra_rays = 0, extra_rays = 0, extra_samples = 0;
  std::uint64_t kept_fragments = 0, kept_pixels = 0;  ///< without rays, by what the last picture knew
};

/// How far a root tile has come.
struct TileProgress {
  std::vector<Fragment> done;      ///< stable fragments that the light reaches
  std::vector<Fragment> children;  ///< to be refined next
  float light_angle = 0;           ///< the largest solid angle of the light in the tile
};

/// Buffers of one thread.
class Refiner {
 public:
  Refiner(const World& world, const View& view, Visibility& visibility, const FragmentOptions& options, std::uint64_t seed);

  /// `prior` may be null: nothing is known of the light.
  void set_light(const AreaLight& light, const LightPoints& points, const PriorShares* prior = nullptr);
  /// From now on tests are written to `map`, which must live as long as this.
  void watch(StageMap& map);
  /// Refines `fragments` (those that geometry left) of root tile `index`, and writes the tile's part of `signal`.
  void refine(const GBuffer& g, std::size_t index, std::span<const Fragment> fragments, std::uint32_t sample, LightSignal& signal,
              TileProgress& progress, PassStatistics& statistics);
  /// Moves from progress.done to progress.children what has to be refined again because of what lies beside it, also in other root tiles:
  /// nothing may be writing to `signal`. Rounds count from 1.
  void find_borders(const GBuffer& g, const LightSignal& signal, int round, TileProgress& progress);
  /// Refines progress.children.
  void refine_borders(const GBuffer& g, std::size_t index, std::uint32_t sample, int round, LightSignal& signal, TileProgress& progress,
                      PassStatistics& statistics);
  const RefinementCounts& counts() const { return counts_; }

  /// The stages below are public for those who refine by other rules: signals of stable fragments from their masks, of pixels, and of none.
  void clear(const GBuffer& g, const RootTile& tile, LightSignal& signal) const;
  void write_level(const GBuffer& g, const Fragment& f, std::uint8_t flags, LightSignal& signal) const;
  void write_constant(const GBuffer& g, const Fragment& f, float value, LightSignal& signal) const;
  void write_stable(const GBuffer& g, const Fragment& f, const ProbeMasks& masks, LightSignal& signal) const;
  /// From the mask that the fragment's centre has for the first set of points.
  void write_centre(const GBuffer& g, const Fragment& f, std::uint64_t mask, LightSignal& signal) const;
  void write_pixels(const GBuffer& g, std::uint32_t sample, LightSignal& signal, PassStatistics& statistics);
  ProbeTest& probes() { return probes_; }
  std::vector<std::uint32_t>& finest() { return finest_; }
  RefinementCounts& counts() { return counts_; }

 private:
  void begin(std::size_t index, std::uint32_t sample);
  void refine_children(const GBuffer& g, std::uint32_t sample, LightSignal& signal, TileProgress& progress, PassStatistics& statistics);
  bool decide_by_prior(const GBuffer& g, const Fragment& f, LightSignal& signal);
  void run_waves(const GBuffer& g, std::uint32_t sample, LightSignal& signal, PassStatistics& statistics);
  void classify(const GBuffer& g, LightSignal& signal);
  void split_to_pixels(const GBuffer& g, const Fragment& f, const ProbeMasks& masks, LightSignal& signal);
  float light_angle(const GBuffer& g, const RootTile& tile) const;
  std::uint32_t pixel_rays() const;
  int penumbra_level() const;
  std::uint64_t all_points() const { return points_->count == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << points_->count) - 1; }
  void confirm(const GBuffer& g, PassStatistics& statistics);
  void write_stable(const GBuffer& g, LightSignal& signal);
  void resolve_penumbrae(const GBuffer& g, std::uint32_t sample, LightSignal& signal, PassStatistics& statistics);
  void write_pixels(const GBuffer& g, std::span<const std::uint32_t> pixels, std::uint32_t rays, std::uint32_t sample, LightSignal& signal,
                    PassStatistics& statistics);
  void add_extras(const GBuffer& g, std::uint32_t sample, LightSignal& signal, PassStatistics& statistics);
  void split(const Fragment& f, const ProbeMasks& masks);
  void map_tests(const GBuffer& g);
  void map_questions(const GBuffer& g, std::span<const Fragment> fragments);
  void map_pixels(std::span<const std::uint32_t> pixels);
  float share(const Receiver& receiver, std::uint32_t set, std::uint64_t mask) const;
  Color irradiance(const Receiver& receiver, std::uint32_t set, const ProbeMasks& masks, int quadrants) const;

  FragmentOptions options_;
  ProbeTest probes_;
  FinestTest finest_test_;
  const AreaLight* light_ = nullptr;
  const LightPoints* points_ = nullptr;
  const PriorShares* prior_ = nullptr;

  ReachPyramid reach_;
  float light_angle_ = 0;
  bool reached_ = false;  ///< the light is known to reach all fragments at hand
  std::vector<Fragment> current_, children_, stable_, unconfirmed_, done_;
  std::vector<ProbeMasks> masks_, stable_masks_;
  std::vector<std::uint64_t> confirmed_;
  std::vector<std::uint32_t> geometry_pixels_;                ///< of level 0 by geometry
  std::vector<std::uint32_t> finest_, extras_, extra_owner_;  ///< an extra sample's fragment: its place in stable_
  std::vector<std::uint32_t> penumbra_, penumbra_at_;         ///< probe pixels, and where their values go
  std::vector<std::uint8_t> contradicted_;
  std::array<std::vector<float>, 3> values_;
  RefinementCounts counts_;
  StageMap* map_ = nullptr;
};

}  // namespace sightline
