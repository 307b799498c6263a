// Light points of the finest level: sets of Sobol points that pixels share.
#pragma once

#include <cstdint>

#include "base/core/aligned.h"
#include "methods/fragments/area_light.h"
#include "shade/light_table.h"
#include "visibility/query_batch.h"

namespace sightline {

/// Sets of points on a light for one sample of the picture. Any first 4^n points of a set are stratified, and the sets of all samples
/// together are as well. A pixel takes one set by its place: to make its own points would take a third of the time of its rays.
class FinestPoints {
 public:
  explicit FinestPoints(std::uint64_t seed) : seed_(seed) {}
  /// Sets of `count` points of `light` for picture sample `sample`, as the light ends of `queries`; nothing to do if they are there
  /// already.
  void make(const LightTable& lights, const AreaLight& light, std::uint32_t sample, std::uint32_t count, QueryBatch& queries);
  /// All points have the same normal, power and sides: those of the first stand for all.
  bool uniform() const { return uniform_; }
  /// Element of the set's first point.
  std::size_t first(std::uint32_t pixel) const { return std::size_t{hash_of(pixel) % sets_} * count_; }

  AlignedVector<float> area;       ///< surface that a point of a whole set stands for: 1 / (count density)
  AlignedVector<float> power;      ///< the same times the luminance of its radiance
  AlignedVector<float> two_sided;  ///< 1 or 0
  Vec3Batch radiance;

 private:
  std::uint32_t hash_of(std::uint32_t pixel) const;

  std::uint64_t seed_;
  const AreaLight* light_ = nullptr;
  std::uint32_t sample_ = 0, count_ = 0, sets_ = 1;
  bool uniform_ = false;
  Vec3Batch front_;
  AlignedVector<std::uint32_t> key_, index_, entry_;
  AlignedVector<float> u0_, u1_, selection_;
  LightSampleBatch samples_;
};

}  // namespace sightline
