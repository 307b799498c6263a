#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "bench/trace_bench_parts.h"

namespace sightline {

std::string text(CallStyle style) {
  return fmt::format("{}{}", style.width, style.width == 1 ? "" : style.coherent ? " coherent" : " incoherent");
}

std::vector<std::vector<double>> by_turns(const std::vector<std::function<double()>>& candidates, int rounds, const Context& context) {
  const std::size_t count = candidates.size();
  std::vector<std::vector<double>> seconds(count);
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < count; ++i) {
      context.check_cancelled();
      const std::size_t turn = (i + static_cast<std::size_t>(round)) % count;
      seconds[turn].push_back(candidates[turn]());
    }
  }
  return seconds;
}

StyleRanking rank_styles(const std::function<double(CallStyle)>& run, bool quick, const Context& context) {
  constexpr int kFirstRounds = 2, kFinalRounds = 2;
  StyleRanking ranking;
  ranking.order.resize(kCallStyles.size());
  std::iota(ranking.order.begin(), ranking.order.end(), std::size_t{0});
  const auto measure = [&](std::size_t candidates, int rounds) {
    std::vector<std::function<double()>> runs;
    runs.reserve(candidates);
    for (std::size_t i = 0; i < candidates; ++i) runs.emplace_back([&, style = kCallStyles[ranking.order[i]]] { return run(style); });
    const std::vector<std::vector<double>> seconds = by_turns(runs, rounds, context);
    for (std::size_t i = 0; i < candidates; ++i) {
      double& least = ranking.seconds[ranking.order[i]];
      const double best = *std::min_element(seconds[i].begin(), seconds[i].end());
      least = least > 0 ? std::min(least, best) : best;
    }
    std::sort(ranking.order.begin(), ranking.order.end(),
              [&](std::size_t a, std::size_t b) { return ranking.seconds[a] < ranking.seconds[b]; });
  };
  measure(kCallStyles.size(), quick ? 1 : kFirstRounds);
  if (!quick) measure(2, kFinalRounds);
  return ranking;
}

}  // namespace sightline
