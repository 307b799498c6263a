#include "shade/scattered_reflectance.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sightline {
namespace {

/// How much a difference in azimuth counts at sin theta_i sin theta_o = x: in full from here on, not at all at the normal.
constexpr float kAzimuthMatters = 0.1f;
float azimuth_weight(float x) { return std::clamp(x / kAzimuthMatters, 0.f, 1.f); }

/// exp(-kFalloff) is what the farthest neighbour counts: nearly nothing, so that it may come and go unseen.
constexpr float kFalloff = 5;

}  // namespace

PairPoint pair_point(const ReflectanceSample& s) {
  const float turn = std::fabs(std::remainder(s.delta_phi, 2 * kPi)) * kInvPi;
  return {std::sin(s.theta_i) * std::sin(s.theta_o), std::min(turn, 1.f), std::cos(s.theta_i) * std::cos(s.theta_o)};
}

PairPoint pair_point(const Vec3& wo, const Vec3& wi) {
  const float sines = std::sqrt((wo.x * wo.x + wo.y * wo.y) * (wi.x * wi.x + wi.y * wi.y));
  const float cosine = sines > 0 ? std::clamp((wo.x * wi.x + wo.y * wi.y) / sines, -1.f, 1.f) : -1.f;
  return {sines, std::acos(cosine) * kInvPi, std::fabs(wo.z * wi.z)};
}

ScatteredReflectance::ScatteredReflectance(std::span<const ReflectanceSample> samples) {
  nodes_.reserve(samples.size());
  for (const ReflectanceSample& sample : samples) nodes_.push_back({pair_point(sample), sample.value, 0});
  build(0, nodes_.size());
}

void ScatteredReflectance::build(std::size_t begin, std::size_t end) {
  if (end - begin < 2) return;
  // Split the longest side of the box in the middle of its points.
  PairPoint lower = nodes_[begin].point, upper = lower;
  for (std::size_t i = begin + 1; i < end; ++i) {
    lower = glm::min(lower, nodes_[i].point);
    upper = glm::max(upper, nodes_[i].point);
  }
  const Vec3 extent = upper - lower;
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : (extent.y >= extent.z ? 1 : 2);
  const std::size_t middle = begin + (end - begin) / 2;
  const auto at = [&](std::size_t i) { return nodes_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end), [axis](const Node& a, const Node& b) { return a.point[axis] < b.point[axis]; });
  nodes_[middle].axis = axis;
  build(begin, middle);
  build(middle + 1, end);
}

/// The nearest samples found so far, as a heap whose top is the farthest.
struct ScatteredReflectance::Search {
  struct Found {
    float distance2;
    const Node* node;
    bool operator<(const Found& other) const { return distance2 < other.distance2; }
  };
  PairPoint point;
  float azimuth;  ///< weight of the azimuth at `point`
  std::array<Found, kNeighbours> heap{};
  int count = 0;

  float distance2(const Node& node) const {
    const float turn = (node.point.y - point.y) * azimuth;
    const float x = node.point.x - point.x, z = node.point.z - point.z;
    return x * x + turn * turn + z * z;
  }
  bool is_near(float distance) const { return count < kNeighbours || distance < heap[0].distance2; }
  void add(const Node& node) {
    const float d = distance2(node);
    if (!is_near(d)) return;
    if (count == kNeighbours) std::pop_heap(heap.begin(), heap.begin() + count--);
    heap[static_cast<std::size_t>(count++)] = {d, &node};
    std::push_heap(heap.begin(), heap.begin() + count);
  }
};

void ScatteredReflectance::visit(Search& search, std::size_t begin, std::size_t end) const {
  if (begin >= end) return;
  const std::size_t middle = begin + (end - begin) / 2;
  const Node& node = nodes_[middle];
  search.add(node);
  if (end - begin == 1) return;
  const float offset = (search.point[node.axis] - node.point[node.axis]) * (node.axis == 1 ? search.azimuth : 1.f);
  const bool below = search.point[node.axis] < node.point[node.axis];
  below ? visit(search, begin, middle) : visit(search, middle + 1, end);
  if (search.is_near(offset * offset)) below ? visit(search, middle + 1, end) : visit(search, begin, middle);
}

Color ScatteredReflectance::at(const PairPoint& point) const {
  Search search{.point = point, .azimuth = azimuth_weight(point.x)};
  visit(search, 0, nodes_.size());
  float farthest = 0;
  for (int i = 0; i < search.count; ++i) farthest = std::max(farthest, search.heap[static_cast<std::size_t>(i)].distance2);
  const float scale = farthest > 1e-20f ? kFalloff / farthest : 0.f;
  Color sum(0);
  float weights = 0;
  for (int i = 0; i < search.count; ++i) {
    const auto& found = search.heap[static_cast<std::size_t>(i)];
    const float weight = std::exp(-found.distance2 * scale);
    sum += weight * found.node->value;
    weights += weight;
  }
  return sum / weights;
}

}  // namespace sightline
