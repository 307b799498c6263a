// Fragments, rays, seconds and errors of the method, its predecessors and its ablations, beside Monte Carlo [Koa2017, Tab. 1].
#include <fmt/format.h>

#include <algorithm>

#include "base/core/error.h"
#include "bench/fragments/candidates.h"
#include "bench/fragments/maps.h"
#include "bench/fragments/parts.h"
#include "bench/fragments/row.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

/// A picture to take part in the rounds.
struct Entry {
  std::string name, key;  ///< key: what aims look for
  RenderRequest request;
  Shot warm;
};

/// The threshold of the predecessor with the least product of error and time.
struct Sweep {
  Json rows = Json::array();
  int best = 0;
};

Sweep sweep_nichols(const BuiltView& view, const FragmentTruth& truth, bool quick, const Context& context) {
  const std::vector<int> thresholds = quick ? std::vector{4, 16} : std::vector{1, 2, 4, 6, 8, 12, 16};
  Sweep sweep;
  double least = 0;
  for (const int threshold : thresholds) {
    const Shot shot = shoot(view, fragments_request(fragments_nichols(threshold).settings), context);
    const Json errors = fragment_errors(truth, shot.image);
    const double product = errors["l2"].get<double>() * shot.seconds;
    if (sweep.best == 0 || product < least) sweep.best = threshold, least = product;
    sweep.rows.push_back(
        {{"threshold", threshold}, {"seconds", shot.seconds}, {"l2", errors["l2"]}, {"rays", shot.statistics.rays.occlusion}});
  }
  return sweep;
}

/// Everything once: what is not available is left out, and caches and frequencies are where they will be.
class Field {
 public:
  Field(const BuiltView& view, const Context& context) : view_(view), context_(context) {}

  void add(const std::string& name, const std::string& key, RenderRequest request) {
    try {
      Shot warm = shoot(view_, request, context_);
      entries_.push_back({name, key, std::move(request), std::move(warm)});
    } catch (const Error& error) {
      if (error.code() != ErrorCode::usage) throw;
      context_.warn(fmt::format("{}: {} left out: {}", view_.name, name, error.what()));
    }
  }
  const std::vector<Entry>& entries() const { return entries_; }

 private:
  const BuiltView& view_;
  const Context& context_;
  std::vector<Entry> entries_;
};

}  // namespace

Json fragment_table(const BuiltView& view, const FragmentBenchOptions& options, std::vector<BenchPicture>& pictures,
                    const Context& context) {
  const FragmentTruth truth = fragment_truth(view, options, context);
  context.info(fmt::format("bench fragments: table, {}", view.name));
  Field field(view, context);
  const auto add = [&](const FragmentCandidate& candidate, const char* key) {
    field.add(candidate.name, key, fragments_request(candidate.settings));
  };
  add(fragments_default(), "default");
  add(fragments_koa(), "koa");
  Sweep sweep;
  try {
    sweep = sweep_nichols(view, truth, options.quick, context);
    add(fragments_nichols(sweep.best), "nichols");
  } catch (const Error& error) {
    if (error.code() != ErrorCode::usage) throw;
    context.warn(fmt::format("{}: the predecessor is left out: {}", view.name, error.what()));
  }
  field.add("Monte Carlo, 64 samples", "monte-carlo-64", monte_carlo_request(64));
  for (const FragmentCandidate& ablation : fragment_ablations()) add(ablation, "ablation");

  const std::vector<Entry>& entries = field.entries();
  const int rounds = options.rounds > 0 ? options.rounds : options.quick ? 1 : 3;
  const std::vector<Shot> shots =
      shoot_by_turns(entries.size(), rounds, [&](std::size_t i) { return shoot(view, entries[i].request, context); });
  const auto monte_carlo = std::find_if(entries.begin(), entries.end(), [](const Entry& entry) { return entry.key == "monte-carlo-64"; });
  Json rows = Json::array();
  for (std::size_t i = 0; i < entries.size(); ++i) {
    Json row = {{"name", entries[i].name}, {"key", entries[i].key}, {"settings", entries[i].request.settings}};
    row.update(fragment_row(truth, shots[i]));
    if (monte_carlo != entries.end())
      row["speed_up"] = shots[static_cast<std::size_t>(monte_carlo - entries.begin())].seconds / std::max(1e-9, shots[i].seconds);
    rows.push_back(std::move(row));
    if (entries[i].key != "ablation") add_maps(view, entries[i].name, entries[i].request, shots[i], truth, pictures, context);
  }
  return {{"view", view.name},
          {"size", {view.size_px.x, view.size_px.y}},
          {"triangles", instanced_triangle_count(view.world->scene())},
          {"truth_samples", truth.samples},
          {"rounds", rounds},
          {"rows", std::move(rows)},
          {"nichols_sweep", std::move(sweep.rows)}};
}

}  // namespace sightline
