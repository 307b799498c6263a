// The arithmetic of the finest level, 16 light samples at a time.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/math/vec.h"
#include "shade/light_table.h"

namespace sightline {

/// Light samples [first, first + count) of one pixel.
struct FinestRun {
  Vec3 shading_normal, geometric_normal;
  const LightSampleBatch& light;
  std::size_t first, count;
};
struct FinestTerms {
  float all = 0;            ///< sum of the terms
  std::uint32_t asked = 0;  ///< terms above 0
};
/// term[i] = cos / (pi pdf), irradiance / pi of unit radiance, times the sample's luminance if `weigh`; 0 for samples that reach the pixel
/// from below either normal, or not at all. light_of[i] becomes i, or kNoQuery where the term is 0.
FinestTerms finest_terms(const FinestRun& run, bool weigh, float* term, std::uint32_t* light_of);

struct FinestSum {
  float visible = 0;       ///< of terms whose weight is above a half
  std::uint32_t seen = 0;  ///< how many
  Color irradiance{0};     ///< of terms times radiance, if asked for
};
FinestSum finest_sum(const FinestRun& run, bool irradiance, const float* term, const float* weight);

}  // namespace sightline
