// Figures of the visibility-cache benchmark that are pure arithmetic.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "image/image.h"
#include "visibility/query_batch.h"

namespace sightline {

/// What the counts of a picture say.
struct QueryFigures {
  double share_traced = 0;       ///< rays / queries
  double ray_reduction = 0;      ///< hits / misses, the paper's measure; infinite without misses
  double lookups_per_query = 0;  ///< neighbours included
  double rejected_share = 0;     ///< look-ups that met another key
};
QueryFigures query_figures(const VisibilityCounts& counts);

/// Σ(I − R) / ΣR over the pixels of the mask (all, if it is empty): the sign that L^INF does not have.
double signed_error(const ColorImage& reference, const ColorImage& image, std::span<const std::uint8_t> mask);

/// The number of samples that take about `budget` seconds if `samples` take `seconds`; at least 1.
int samples_in_time(int samples, double seconds, double budget);

/// How much an error changes from frame to frame: with d = image − exact, Σ|d_t − d_{t−1}| / ΣI over all frames but the first.
class Flicker {
 public:
  void add(const ColorImage& exact, const ColorImage& image);
  double value() const { return light_ > 0 ? change_ / light_ : 0; }

 private:
  ColorImage difference_;
  double change_ = 0, light_ = 0;
};

}  // namespace sightline
