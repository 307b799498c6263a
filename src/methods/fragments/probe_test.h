// Visibility tests inside fragments: four quadrants ask the same points of a light.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "methods/eye_footprint.h"
#include "methods/fragments/area_light.h"
#include "methods/fragments/fragment.h"
#include "methods/fragments/g_buffer.h"
#include "methods/method.h"

namespace sightline {

/// From this level on each quadrant has four probes, which share out the light's points [Koa2017].
inline constexpr int kManyProbesLevel = 5;

/// Up to this level a few rays may answer for a fragment: what they miss, neighbours mostly show.
inline constexpr int kSparseLevel = 3;

/// Pixel of the probe of quadrant `q`, or of the `sub`-th of its four from kManyProbesLevel on; moved into the picture.
IVec2 probe_pixel(const GBuffer& g, const Fragment& f, int q, int sub = -1);
/// Which of a quadrant's four probes asks point k: one point of every 2 x 2 block of strata each.
constexpr int sub_probe_of(std::uint32_t k, std::uint32_t count) {
  const std::uint32_t columns = count == 16 ? 4 : 8;
  return static_cast<int>((k % columns & 1) + 2 * (k / columns & 1));
}

/// Buffers of one thread.
class ProbeTest {
 public:
  ProbeTest(const World& world, const View& view, Visibility& visibility, std::uint64_t seed);

  /// `sample` of the picture: each has light points of its own, so that their mean converges.
  void begin(std::uint32_t scope, std::uint32_t sample = 0) {
    worker_->begin(scope);
    salt_ = static_cast<std::uint64_t>(sample) << 32;
  }
  /// The light that is asked from now on. `points` must live as long as it is.
  void set_light(const AreaLight& light, const LightPoints& points);
  /// masks[i] of fragments[i], which have level >= 1.
  void test(const GBuffer& g, std::span<const Fragment> fragments, std::vector<ProbeMasks>& masks, PassStatistics& statistics);
  /// One more probe each at a random pixel of the fragment, which asks the same points as its quadrants did.
  void confirm(const GBuffer& g, std::span<const Fragment> fragments, std::uint32_t round, std::vector<std::uint64_t>& masks,
               PassStatistics& statistics);
  /// From now on small fragments ask each of the light's points once first, and all the rest only if the answers differ.
  void ask_sparsely() { sparse_ = true; }
  /// From now on asked()[i] is how many questions fragment i of the last test or confirmation has asked; exact visibility traces as many
  /// rays.
  void count_questions() { counts_questions_ = true; }
  const std::vector<std::uint32_t>& asked() const { return asked_; }
  /// The set of light points that a fragment uses.
  std::uint32_t set_of(const Fragment& f) const;

 private:
  void add_eye(const GBuffer& g, IVec2 pixel);
  void add_query(std::size_t query, std::uint32_t eye, std::uint32_t light);
  void ask(PassStatistics& statistics);
  void ask_some(const GBuffer& g, std::span<const Fragment> fragments, std::span<const std::uint32_t> which, const ProbeMasks& some,
                std::vector<ProbeMasks>& masks, PassStatistics& statistics);
  void count_questions(std::size_t fragment, std::size_t first, std::size_t count);

  EyeFootprint footprint_;
  Vec3 camera_;
  bool orthographic_;
  bool exact_;
  std::uint64_t seed_, salt_ = 0;
  std::unique_ptr<VisibilityWorker> worker_;
  const AreaLight* light_ = nullptr;
  const LightPoints* points_ = nullptr;
  std::vector<std::uint8_t> above_;  ///< by eye end: the whole light lies above its surface
  QueryBatch queries_;
  AlignedVector<float> weights_;
  std::vector<std::uint32_t> open_, small_;
  bool sparse_ = false, counts_questions_ = false;
  std::vector<std::uint32_t> asked_;
};

}  // namespace sightline
