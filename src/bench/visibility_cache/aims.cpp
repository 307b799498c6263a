#include "bench/visibility_cache/aims.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "bench/bench_aims.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

constexpr BenchAims::Shown kPercent = BenchAims::Shown::percent;

/// Rows of the curves of one view and number of samples a pixel; null where they were not measured.
Json rows_of(const Json& results, const std::string& view, int spp) {
  for (const Json& curves : results["curves"]) {
    if (curves["view"] != view) continue;
    for (const Json& sample : curves["samples"]) {
      if (sample["spp"] == spp) return sample["cached"];
    }
  }
  return {};
}

Json row_of(const Json& results, const std::string& view, int spp, double ce) {
  for (const Json& row : rows_of(results, view, spp)) {
    if (row["ce"] == ce) return row;
  }
  return {};
}

std::string place(const std::string& view, int spp, double ce) { return fmt::format("{}, C_E {}, {} spp", view, ce, spp); }

void rays(const Json& results, const std::string& view, int spp, double ce, double share, std::optional<double> error, BenchAims& aims) {
  const Json row = row_of(results, view, spp, ce);
  if (row.is_null()) return;
  aims.at_most(place(view, spp, ce) + ": traced", row["share_traced"], share, kPercent);
  if (error) aims.at_most(place(view, spp, ce) + ": L^INF", row["linf"], *error, kPercent);
}

void speed(const Json& results, const std::string& view, int spp, double ce, double speed_up, double error, BenchAims& aims) {
  const Json row = row_of(results, view, spp, ce);
  if (row.is_null()) return;
  aims.at_least(place(view, spp, ce) + ": speed-up", row["speed_up"], speed_up);
  aims.at_most(place(view, spp, ce) + ": L^INF", row["linf"], error, kPercent);
}

// The fastest whose error is small enough.
void best_speed(const Json& results, const std::string& view, int spp, double speed_up, double error, BenchAims& aims) {
  std::optional<Json> best;
  for (const Json& row : rows_of(results, view, spp)) {
    if (!(row["linf"].get<double>() <= error)) continue;
    if (!best || row["speed_up"] > (*best)["speed_up"]) best = row;
  }
  if (best)
    aims.at_least(
        fmt::format("{}, the best with L^INF of at most {} %: speed-up", place(view, spp, (*best)["ce"].get<double>()), 100 * error),
        (*best)["speed_up"], speed_up);
}

void shadow_maps(const Json& results, BenchAims& aims) {
  for (const Json& view : results["shadow_maps"]) {
    for (const Json& sample : view["samples"]) {
      const Json& rows = sample["rows"];
      // The first is exact; then come the cache's, then the maps.
      const auto of_cache = [](const Json& row) { return row["name"].get<std::string>().starts_with("cached"); };
      std::size_t maps = 2;
      while (maps < rows.size() && of_cache(rows[maps])) ++maps;
      if (maps >= rows.size()) continue;
      double least = rows[maps]["flip"].get<double>();
      for (std::size_t i = maps + 1; i < rows.size(); ++i) least = std::min(least, rows[i]["flip"].get<double>());
      const std::string where = place(view["view"].get<std::string>(), sample["spp"].get<int>(), view["ce"].get<double>());
      for (std::size_t i = 1; i < maps; ++i)
        aims.at_most(fmt::format("{}, {}: FLIP; the aim is the best shadow map's", where, rows[i]["name"].get<std::string>()),
                     rows[i]["flip"], least);
    }
  }
}

}  // namespace

Json cache_bench_aims(const Json& results) {
  BenchAims aims;
  rays(results, "sponza-points", 16, 36, 0.02, 0.01, aims);
  for (const char* view : {"sponza-court", "conference-9"}) {
    rays(results, view, 16, 64, 0.04, {}, aims);
    rays(results, view, 1, 8, 0.07, 0.01, aims);
  }
  for (const int spp : {1, 9, 16}) best_speed(results, "kitchen-vpl", spp, 2, 0.03, aims);
  speed(results, "hairball-open", 1, 16, 1.7, 0.07, aims);
  speed(results, "hairball-open", 16, 64, 2.5, 0.07, aims);
  shadow_maps(results, aims);
  for (const Json& view : results["lookup"]) {
    const std::string name = view["view"].get<std::string>();
    for (const Json& row : view["rows"]) {
      const bool refined = row["lookups_per_query"] > 1;
      aims.at_most(fmt::format("{}, {}: ns a query", name, row["name"].get<std::string>()), row["ns_per_query"], refined ? 12 : 5);
    }
    if (view["exact"].contains("throughput_kept"))
      aims.at_least(name + ": exact path of the bare calls' throughput", view["exact"]["throughput_kept"], 0.9, kPercent);
  }
  for (const Json& view : results["flicker"]) {
    const std::string name = view["view"].get<std::string>();
    aims.at_most(name + ": flicker", view["flicker"], 0.01, kPercent);
    aims.at_least(name + ": cached frames a second", view["cached_frames_per_second"], 4);
  }
  return aims.take();
}

}  // namespace sightline
