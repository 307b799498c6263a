// The finest level: pixels that trace their own stratified rays.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "methods/eye_footprint.h"
#include "methods/fragments/area_light.h"
#include "methods/fragments/finest_lanes.h"
#include "methods/fragments/finest_points.h"
#include "methods/fragments/g_buffer.h"
#include "methods/fragments/history.h"
#include "methods/fragments/unshadowed.h"
#include "methods/method.h"

namespace sightline {

struct FinestOptions {
  std::uint32_t rays = 64;          ///< of pixels that geometry made so small, where they are many: nothing smooths them
  std::uint32_t smooth_rays = 32;   ///< of all others
  std::uint32_t crowded_rays = 64;  ///< instead of `rays`, in root tiles that are mostly such pixels
  bool early_out = true;            ///< a quarter of the rays first; done if all of them agree
};

/// Buffers of one thread.
class FinestTest {
 public:
  FinestTest(const World& world, const View& view, Visibility& visibility, const FinestOptions& options, std::uint64_t seed);

  void begin(std::uint32_t scope) { worker_->begin(scope); }
  /// From now on pixels take over what is known of them, and trace a few rays only now and then. Null: nothing is known.
  void set_prior(const PriorShares* prior) { prior_ = prior; }
  /// The signal of `light`, by `rays` rays each, at the given pixels (elements of the GBuffer) in picture sample `sample`; values[c][i] for
  /// channel c: the visible share for one channel, irradiance / pi for three.
  void test(const GBuffer& g, const AreaLight& light, std::span<const std::uint32_t> pixels, std::uint32_t sample, std::uint32_t rays,
            int channels, std::array<std::vector<float>, 3>& values, PassStatistics& statistics);
  /// How many questions pixel `i` of the last test has asked; exact visibility traces as many rays.
  std::uint32_t asked(std::size_t i) const { return sums_[i].asked; }
  /// With what is known taken into account: how many rays stand behind pixel `i` of the last test, and how many pixels have traced none.
  std::uint8_t known(std::size_t i) const { return known_[i]; }
  std::size_t kept() const { return kept_; }

 private:
  /// Traces rays [first, first + count) of the listed pixels and adds to their sums.
  void trace(const GBuffer& g, std::span<const std::uint32_t> pixels, std::span<const std::uint32_t> which, std::uint32_t first,
             std::uint32_t count, bool ratio, PassStatistics& statistics);

  void take_prior(const GBuffer& g, std::span<const std::uint32_t> pixels, std::uint32_t rays, std::vector<float>& values);
  void blend_prior(std::span<const std::uint32_t> pixels, std::uint32_t first, std::uint32_t rays, std::vector<float>& values);
  void close_saturated(const GBuffer& g, std::span<const std::uint32_t> pixels, std::uint32_t first);
  FinestTerms weigh_by_lobe(const Receiver& receiver, const FinestRun& run);

  struct Sums {
    float visible = 0, all = 0;
    Color irradiance{0};
    std::uint32_t asked = 0, seen = 0;
  };
  const World& world_;
  FinestOptions options_;
  EyeFootprint footprint_;
  Vec3 camera_;
  bool orthographic_, exact_;
  std::unique_ptr<VisibilityWorker> worker_;
  FinestPoints points_;
  std::vector<Sums> sums_;
  std::vector<std::uint32_t> open_;
  const PriorShares* prior_ = nullptr;
  std::vector<PriorShares::Value> prior_values_;  ///< by pixel, with a prior; without rays: not to be used
  std::vector<std::uint32_t> penumbra_;           ///< pixels that are done, and beside which all or nothing is mostly chance
  std::vector<std::uint8_t> known_;
  std::size_t kept_ = 0;
  std::vector<std::uint8_t> mixed_;  ///< laid out as the GBuffer; 0 between calls
  std::vector<FinestRun> runs_;
  AlignedVector<float> term_, weights_;
  QueryBatch queries_;
};

}  // namespace sightline
