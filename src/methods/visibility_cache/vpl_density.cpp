#include "methods/visibility_cache/vpl_density.h"

#include <algorithm>
#include <numeric>

#include "base/math/bounds.h"
#include "base/parallel/parallel.h"

namespace sightline::vpl {
namespace {

constexpr std::size_t kLeaf = 8;

/// Points in the order of a balanced tree: the middle of a range splits it along an axis, left part below, right part above.
class PointTree {
 public:
  explicit PointTree(std::span<const Vec3> points) : points_(points), order_(points.size()), axis_(points.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    split(0, points.size());
  }

  /// Squared distances of the nearest neighbours of point `self`, a max-heap filled up to its size.
  struct Nearest {
    std::span<float> squared;
    std::size_t found = 0;

    float reach() const { return found < squared.size() ? std::numeric_limits<float>::infinity() : squared[0]; }
    void add(float d) {
      if (!(d < reach())) return;
      if (found == squared.size()) {
        std::pop_heap(squared.begin(), squared.end());
        --found;
      }
      squared[found++] = d;
      std::push_heap(squared.begin(), squared.begin() + static_cast<std::ptrdiff_t>(found));
    }
  };
  void find(std::uint32_t self, Nearest& nearest) const { find(self, 0, points_.size(), nearest); }

 private:
  void split(std::size_t begin, std::size_t end) {
    if (end - begin <= kLeaf) return;
    Bounds bounds;
    for (std::size_t i = begin; i < end; ++i) bounds.add(points_[order_[i]]);
    const Vec3 extent = bounds.extent();
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    const std::size_t middle = (begin + end) / 2;
    const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) { return points_[a][axis] < points_[b][axis]; });
    axis_[middle] = static_cast<std::uint8_t>(axis);
    split(begin, middle);
    split(middle + 1, end);
  }

  void visit(std::uint32_t self, std::size_t i, Nearest& nearest) const {
    if (order_[i] != self) nearest.add(length_squared(points_[order_[i]] - points_[self]));
  }

  void find(std::uint32_t self, std::size_t begin, std::size_t end, Nearest& nearest) const {
    if (end - begin <= kLeaf) {
      for (std::size_t i = begin; i < end; ++i) visit(self, i, nearest);
      return;
    }
    const std::size_t middle = (begin + end) / 2;
    const int axis = axis_[middle];
    const float away = points_[self][axis] - points_[order_[middle]][axis];
    const bool above = away > 0;
    find(self, above ? middle + 1 : begin, above ? end : middle, nearest);
    visit(self, middle, nearest);
    if (away * away < nearest.reach()) find(self, above ? begin : middle + 1, above ? middle : end, nearest);
  }

  std::span<const Vec3> points_;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint8_t> axis_;
};

}  // namespace

std::vector<float> neighbour_areas(std::span<const Vec3> points, std::size_t k, float smallest, float largest, const Context& context) {
  std::vector<float> areas(points.size(), largest);
  if (points.size() < 2 || k == 0) return areas;
  const PointTree tree(points);
  parallel_for(context, points.size(), 256, [&](std::size_t begin, std::size_t end) {
    std::vector<float> squared(std::min(k, points.size() - 1));
    for (std::size_t i = begin; i < end; ++i) {
      PointTree::Nearest nearest{squared};
      tree.find(static_cast<std::uint32_t>(i), nearest);
      const float area = kPi * *std::max_element(squared.begin(), squared.end()) / static_cast<float>(squared.size());
      areas[i] = std::min(std::max(area, smallest), largest);
    }
  });
  return areas;
}

}  // namespace sightline::vpl
