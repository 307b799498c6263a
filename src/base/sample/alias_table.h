// Discrete sampling in constant time.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace sightline {

/// Chooses index i with probability weight[i] / sum [Vose1991]. Entries of weight 0 are never chosen. Immutable once built, thread-safe.
///
/// A float in [0,1) has 24 bits, of which log2(n) choose the bin: probabilities are met to an absolute 2^-24, and `u` of a choice among
/// many entries has few bits left.
class AliasTable {
 public:
  struct Choice {
    std::uint32_t index;
    float probability;
    float u;  ///< the random number stretched back to [0,1)
  };
  /// A bin holds its own index below `threshold` and `alias` above: what vector code gathers.
  struct Bin {
    float threshold;
    std::uint32_t alias;
  };

  AliasTable() = default;
  /// Weights that are negative or not finite count as 0. If all are 0 the table is empty of choices: can_sample() is false.
  explicit AliasTable(std::span<const float> weights);

  Choice sample(float u) const {
    const float n = static_cast<float>(bins_.size());
    const float scaled = u * n;
    // u * n may round up to n; anything that is no number in [0,1) is taken as the end.
    const std::uint32_t bin = scaled >= 0 && scaled < n ? static_cast<std::uint32_t>(scaled) : static_cast<std::uint32_t>(bins_.size()) - 1;
    const float rest = scaled - static_cast<float>(bin);
    const Bin& b = bins_[bin];
    const bool own = rest < b.threshold;
    const float stretched = own ? rest / b.threshold : (rest - b.threshold) / (1 - b.threshold);
    const std::uint32_t index = own ? bin : b.alias;
    return {index, probabilities_[index], stretched < 0x1.fffffep-1f ? stretched : 0x1.fffffep-1f};
  }
  float probability(std::uint32_t index) const { return probabilities_[index]; }
  bool can_sample() const { return sum_ > 0; }
  std::size_t size() const { return bins_.size(); }
  double sum() const { return sum_; }  ///< of the weights
  std::span<const Bin> bins() const { return bins_; }
  std::span<const float> probabilities() const { return probabilities_; }
  std::uint64_t memory_bytes() const { return bins_.size() * (sizeof(Bin) + sizeof(float)); }

 private:
  std::vector<Bin> bins_;
  std::vector<float> probabilities_;
  double sum_ = 0;
};

}  // namespace sightline
