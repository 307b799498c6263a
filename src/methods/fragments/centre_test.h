// Visibility tests from the centres of fragments: the same points of the light for all of them.
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

/// Buffers of one thread.
class CentreTest {
 public:
  CentreTest(const View& view, Visibility& visibility);

  void begin(std::uint32_t scope) { worker_->begin(scope); }
  /// As with ProbeTest.
  void count_questions() { counts_questions_ = true; }
  const std::vector<std::uint32_t>& asked() const { return asked_; }
  void set_light(const AreaLight& light, const LightPoints& points);
  /// masks[i]: which points of the first set the centre of fragments[i] sees.
  void test(const GBuffer& g, std::span<const Fragment> fragments, std::vector<std::uint64_t>& masks, PassStatistics& statistics);

 private:
  EyeFootprint footprint_;
  Vec3 camera_;
  bool orthographic_, exact_;
  std::unique_ptr<VisibilityWorker> worker_;
  const AreaLight* light_ = nullptr;
  QueryBatch queries_;
  AlignedVector<float> weights_;
  bool counts_questions_ = false;
  std::vector<std::uint32_t> asked_;
};

/// The pixel in the middle of a fragment, moved into the picture.
inline IVec2 centre_pixel(const GBuffer& g, const Fragment& f) {
  const int half = f.width() / 2;
  return {std::min(f.x + half, g.width - 1), std::min(f.y + half, g.height - 1)};
}

}  // namespace sightline
