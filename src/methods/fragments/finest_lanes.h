// The arithmetic of the finest level, 16 light samples at a time.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/math/vec.h"
#include "methods/fragments/finest_points.h"

namespace sightline {

/// Light points [first, first + count) as one pixel sees them; in arrays of answers they are lanes [lane, lane + count).
struct FinestRun {
  Vec3 position, shading_normal, geometric_normal;
  const FinestPoints& points;
  const QueryEnds& ends;  ///< of the points
  std::size_t first, count, lane;
};
struct FinestTerms {
  float all = 0;            ///< sum of the terms
  std::uint32_t asked = 0;  ///< terms above 0
};
/// Terms of [Koa2017, Eq. 3]: irradiance / pi of unit radiance, times the point's luminance if `weigh`; 0 for points below either normal's
/// horizon, and for those that face away. light_of becomes the point, or kNoQuery where the term is 0.
FinestTerms finest_terms(const FinestRun& run, bool weigh, float* term, std::uint32_t* light_of);

struct FinestSum {
  float visible = 0;       ///< of terms whose weight is above a half
  std::uint32_t seen = 0;  ///< how many
  Color irradiance{0};     ///< of terms times radiance, if asked for
};
FinestSum finest_sum(const FinestRun& run, bool irradiance, const float* term, const float* weight);

}  // namespace sightline
