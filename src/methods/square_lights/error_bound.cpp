#include "methods/square_lights/error_bound.h"

#include <algorithm>
#include <cmath>

namespace sightline::square_lights {

Moments moments_of(std::span<const float> values) {
  if (values.empty()) return {};
  const auto count = static_cast<double>(values.size());
  double mean = 0, second = 0, third = 0;
  for (const float v : values) mean += v;
  mean /= count;
  for (const float v : values) {
    const double d = std::fabs(v - mean);
    second += d * d;
    third += d * d * d;
  }
  return {static_cast<float>(mean), static_cast<float>(std::sqrt(second / count)), static_cast<float>(std::cbrt(third / count))};
}

void CutRefiner::split_open(const MergeTree& tree, float limit, std::size_t most, double& total) {
  order_.clear();
  for (std::uint32_t i = 0; i < open_.size(); ++i) {
    const MergeNode& node = tree.nodes()[static_cast<std::size_t>(open_[i])];
    if (terms_[i].bound > limit && node.left >= 0 && total > 0) {
      order_.push_back(i);
    } else {
      result_.push_back(open_[i]);
    }
  }
  // Each split adds one node; where there is no room for all, the worst go first.
  const std::size_t standing = result_.size() + order_.size(), room = most > standing ? most - standing : 0;
  if (room < order_.size()) {
    const auto worse = [this](std::uint32_t a, std::uint32_t b) {
      return terms_[a].bound != terms_[b].bound ? terms_[a].bound > terms_[b].bound : open_[a] < open_[b];
    };
    std::sort(order_.begin(), order_.end(), worse);
    for (std::size_t k = room; k < order_.size(); ++k) result_.push_back(open_[order_[k]]);
    order_.resize(room);
  }
  next_.clear();
  for (const std::uint32_t i : order_) {
    const MergeNode& node = tree.nodes()[static_cast<std::size_t>(open_[i])];
    next_.push_back(node.left);
    next_.push_back(node.right);
    total -= terms_[i].value;
  }
  open_.swap(next_);
}

}  // namespace sightline::square_lights
