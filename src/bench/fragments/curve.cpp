// Monte Carlo over its number of samples, and what ours is worth on that scale.
#include <fmt/format.h>

#include "bench/fragments/bars.h"
#include "bench/fragments/candidates.h"
#include "bench/fragments/parts.h"
#include "bench/fragments/row.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

TimedError timed_error(const Json& row) { return {row["seconds"].get<double>(), row["l2"].get<double>(), row["psnr"].get<double>()}; }

Json or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

}  // namespace

Json fragment_curve(const BuiltView& view, const FragmentBenchOptions& options, const Context& context) {
  const FragmentTruth truth = fragment_truth(view, options, context);
  context.info(fmt::format("bench fragments: curve, {}", view.name));
  const std::vector<int> samples = options.quick ? std::vector{4, 16, 64} : std::vector{4, 8, 16, 24, 32, 48, 64, 128, 256};
  std::vector<RenderRequest> requests = {fragments_request(fragments_default().settings)};
  for (const int n : samples) requests.push_back(monte_carlo_request(n));

  // Once for warming up, with the largest number of samples left out: it has no cold start left by then.
  for (std::size_t i = 0; i + 1 < requests.size(); ++i) shoot(view, requests[i], context);
  const int rounds = options.rounds > 0 ? options.rounds : options.quick ? 1 : 3;
  const std::vector<Shot> shots = shoot_by_turns(requests.size(), rounds, [&](std::size_t i) { return shoot(view, requests[i], context); });

  Json ours = fragment_row(truth, shots.front()), rows = Json::array();
  std::vector<CurvePoint> curve;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    Json row = {{"samples", samples[i]}, {"seconds", shots[i + 1].seconds}, {"rays", shots[i + 1].statistics.rays.occlusion}};
    row.update(fragment_errors(truth, shots[i + 1].image));
    curve.push_back({samples[i], timed_error(row)});
    rows.push_back(std::move(row));
  }
  const TimedError mine = timed_error(ours);
  const EqualError equal = equal_error(curve, mine);
  return {{"view", view.name},
          {"size", {view.size_px.x, view.size_px.y}},
          {"truth_samples", truth.samples},
          {"rounds", rounds},
          {"ours", std::move(ours)},
          {"rows", std::move(rows)},
          {"equal_error",
           {{"samples", equal.samples},
            {"ratio", equal.ratio},
            {"interpolated_samples", or_null(equal.interpolated_samples)},
            {"interpolated_ratio", or_null(equal.interpolated_ratio)}}},
          {"against_64", or_null(time_ratio(curve, 64, mine))},
          {"equal_time_db", or_null(equal_time_gain(curve, mine))}};
}

}  // namespace sightline
