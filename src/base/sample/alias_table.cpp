#include "base/sample/alias_table.h"

#include <cmath>
#include <cstddef>

namespace sightline {

AliasTable::AliasTable(std::span<const float> weights) : bins_(weights.size()), probabilities_(weights.size()) {
  const auto valid = [](float w) { return w > 0 && std::isfinite(w) ? static_cast<double>(w) : 0.0; };
  for (const float w : weights) sum_ += valid(w);
  if (!(sum_ > 0)) return;

  // Bins are filled to the mean weight: what a small weight leaves free, a large one takes.
  const double scale = static_cast<double>(weights.size()) / sum_;
  std::vector<double> fill(weights.size());
  std::vector<std::uint32_t> small, large;
  small.reserve(weights.size());
  large.reserve(weights.size());
  std::uint32_t largest = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    fill[i] = valid(weights[i]) * scale;
    probabilities_[i] = static_cast<float>(valid(weights[i]) / sum_);
    (fill[i] < 1 ? small : large).push_back(static_cast<std::uint32_t>(i));
    if (probabilities_[i] > probabilities_[largest]) largest = static_cast<std::uint32_t>(i);
  }
  while (!small.empty() && !large.empty()) {
    const std::uint32_t low = small.back(), high = large.back();
    small.pop_back();
    bins_[low] = {static_cast<float>(fill[low]), high};
    fill[high] -= 1 - fill[low];
    if (fill[high] < 1) {
      large.pop_back();
      small.push_back(high);
    }
  }
  // What remains is full but for rounding; an entry that must never be chosen must not become full by it.
  for (const std::uint32_t i : large) bins_[i] = {1, i};
  for (const std::uint32_t i : small) bins_[i] = probabilities_[i] > 0 ? Bin{1, i} : Bin{0, largest};
}

}  // namespace sightline
