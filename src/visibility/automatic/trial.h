// Which of two ways of answering is cheaper, from what both cost so far.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace sightline {

/// Pure logic: no clock, no threads.
class Trial {
 public:
  enum Side : std::uint8_t { cached, exact };
  struct Cost {
    double seconds = 0;
    std::uint64_t queries = 0;
    int scopes = 0;
    double per_query() const { return queries > 0 ? seconds / static_cast<double>(queries) : 0; }
  };
  /// Scopes and queries that each side must have answered before the verdict.
  static constexpr int kScopes = 3;
  static constexpr std::uint64_t kQueries = 20000;

  /// Which side should answer the next scope.
  Side next() const { return costs_[cached].scopes <= costs_[exact].scopes ? cached : exact; }
  void add(Side side, double seconds, std::uint64_t queries) {
    if (queries == 0) return;
    Cost& cost = costs_[side];
    cost.seconds += seconds, cost.queries += queries, ++cost.scopes;
  }
  /// The cheaper side, once both have shown enough.
  std::optional<Side> verdict() const {
    for (const Cost& cost : costs_) {
      if (cost.scopes < kScopes || cost.queries < kQueries) return std::nullopt;
    }
    return costs_[cached].per_query() <= costs_[exact].per_query() ? cached : exact;
  }
  const Cost& cost(Side side) const { return costs_[side]; }

 private:
  std::array<Cost, 2> costs_;
};

}  // namespace sightline
