// Reflectance measured at scattered pairs of directions, and a value between them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/math/vec.h"

namespace sightline {

/// One measurement of an isotropic surface: angles from the normal, the azimuth between the two directions (pi: mirrored), the value f.
struct ReflectanceSample {
  float theta_i = 0, theta_o = 0, delta_phi = 0;
  Color value{0};
};

/// A pair of directions as a point such that f changes slowly and swapping the directions changes nothing:
/// (sin theta_i sin theta_o, delta_phi / pi, cos theta_i cos theta_o), the mapping of irregularly sampled BRDFs in [PharrHumphreys2010,
/// §8.6.2]. Near x = 0, where one direction is the normal, the azimuth means little.
using PairPoint = Vec3;
PairPoint pair_point(const ReflectanceSample& sample);
PairPoint pair_point(const Vec3& wo, const Vec3& wi);

/// A k-d tree over the samples' points; the value in between is the Gaussian-weighted mean of the nearest samples, the Gaussian as wide as
/// they are apart. Immutable.
///
/// Deviation: [PharrHumphreys2010, §8.6.2] fixes the Gaussian's width and widens the search until enough is found, which jumps. Distances
/// along the azimuth count less where the azimuth means less, else the value at normal incidence would depend on it.
class ScatteredReflectance {
 public:
  /// At least one sample.
  explicit ScatteredReflectance(std::span<const ReflectanceSample> samples);
  Color at(const PairPoint& point) const;
  std::size_t size() const { return nodes_.size(); }

 private:
  static constexpr int kNeighbours = 12;
  struct Node {
    PairPoint point;
    Color value;
    int axis = 0;
  };
  struct Search;
  void build(std::size_t begin, std::size_t end);
  void visit(Search& search, std::size_t begin, std::size_t end) const;

  std::vector<Node> nodes_;  ///< a balanced tree in place: the middle of a range is its root
};

}  // namespace sightline
