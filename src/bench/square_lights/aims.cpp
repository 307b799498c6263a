#include "bench/square_lights/aims.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "bench/bench_aims.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

constexpr BenchAims::Shown kPercent = BenchAims::Shown::percent;

std::string name_of(const Json& part) { return part["view"].get<std::string>(); }

Json row_of(const Json& rows, const char* basis, int count) {
  for (const Json& row : rows) {
    if (row["basis"] == basis && row["lights"] == count) return row;
  }
  return {};
}

void of_errors(const Json& view, BenchAims& aims) {
  const std::string name = name_of(view);
  const bool sun = name.ends_with("-sun");
  const auto of = [&](const char* basis, int count, const char* error) {
    const Json row = row_of(view["rows"], basis, count);
    return row.is_null() ? Json() : row[error];
  };
  const Json at_30 = of("squares", 30, "l2"), at_100 = of("squares", 100, "l2");
  aims.at_most(name + ": l2 of splitting the light into 30", of("squares", 30, "l2_tables"), 5e-3, kPercent);
  aims.at_most(name + ": l2 of splitting the light into 100", of("squares", 100, "l2_tables"), 7e-4, kPercent);
  aims.at_most(name + ": l2 of 30 squares", at_30, sun ? 1e-2 : 5e-3, kPercent);
  aims.at_most(name + ": l2 of 100 squares", at_100, sun ? 3e-3 : 1e-3, kPercent);
  if (const Json haar = of("haar", 30, "l2"); haar.is_number())
    aims.at_most(name + ": l2 of 30 squares, below 30 wavelets", at_30, haar.get<double>(), kPercent);
}

// Of the environments of one content, in how many squares have less error than as many wavelets.
void of_wavelets(const Json& errors, BenchAims& aims) {
  constexpr int kCount = 100, kLeast = 3, kEnvironments = 4;
  std::map<std::string, std::pair<int, int>> won;
  for (const Json& view : errors) {
    const Json ours = row_of(view["rows"], "squares", kCount), theirs = row_of(view["rows"], "haar", kCount);
    const std::string name = name_of(view);
    const std::size_t sky = name.find("-sky");
    if (ours.is_null() || theirs.is_null() || sky == std::string::npos) continue;
    auto& [wins, of] = won[name.substr(0, sky)];
    wins += ours["l2"] < theirs["l2"], ++of;
  }
  for (const auto& [content, count] : won) {
    if (count.second == kEnvironments)
      aims.at_least(content + ": environments of four in which 100 squares are below 100 wavelets", count.first, kLeast);
  }
}

void of_bakes(const Json& view, BenchAims& aims) {
  const std::string name = name_of(view);
  double slowest_field = 0;
  for (const Json& row : view["rows"]) {
    const std::string kind = row["kind"].get<std::string>();
    if (kind.ends_with(".lights")) aims.at_most(name + ": seconds to split the light", row["seconds"], 1);
    if (kind.ends_with(".self-visibility") && view["parts"] == 0) aims.at_most(name + ": seconds of self-visibility", row["seconds"], 15);
    if (kind.ends_with(".occluder-field")) slowest_field = std::max(slowest_field, row["seconds"].get<double>());
  }
  if (slowest_field > 0) aims.at_most(name + ": seconds of the slowest occluder field", slowest_field, 18);
}

void of_speed(const Json& view, BenchAims& aims) {
  const std::string name = name_of(view);
  const int parts = view["parts"].get<int>();
  if (parts == 0) {
    aims.at_least(name + ": frames a second, nothing moving but light and camera", view["frames_per_second"], 25);
    aims.at_least(name + ": frames a second of shading alone", view["shading_frames_per_second"], 35);
  } else if (parts == 5) {
    aims.at_least(name + ": frames a second with 5 moving parts", view["frames_per_second"], 10);
  }
  aims.at_most(name + ": rays but primary ones while frames are made", view["occlusion_rays"], 0);
}

void of_edit(const Json& view, BenchAims& aims) {
  for (const Json& row : view["rows"]) {
    if (!row["isotropic"].is_boolean()) continue;
    aims.at_most(name_of(view) + ": seconds from a change to the picture, " + row["name"].get<std::string>(), row["seconds"],
                 row["isotropic"].get<bool>() ? 0.05 : 0.5);
  }
}

void of_storage(const Json& view, BenchAims& aims) {
  const bool occluders = view["tables_of"] == "occluders";
  for (const Json& row : view["rows"]) {
    const std::string what = name_of(view) + ", " + row["name"].get<std::string>() + ": ";
    if (!row["compressed"].get<bool>()) {
      if (!occluders) aims.at_most(what + "bytes a vertex", row["bytes_each"], 1024 * 1.01);
      continue;
    }
    // Those of the paper's text; the others show the range.
    const std::string name = row["name"].get<std::string>();
    if (name != "256 clusters, 8 vectors" && name != "8 vectors") continue;
    aims.at_least(what + "smaller than floats by", row["ratio"], occluders ? 40 : 30);
    aims.at_most(what + "percentage points of l2 more than raw", row["more_points"], 0.05);
  }
}

void of_rotation(const Json& view, BenchAims& aims) {
  if (view["turned"].is_object())
    aims.at_most(name_of(view) + ": light turned against scene turned back, relative", view["turned"]["relative_rms"], 1e-5);
  aims.at_most(name_of(view) + ": change from step to step, of that of all texels", view["ratio"], 1.3);
}

void of_moving(const Json& view, BenchAims& aims) {
  const std::string name = name_of(view);
  aims.at_most(name + ": FLIP of the worst frame", view["worst_flip"], name.ends_with("-sun") ? 0.10 : 0.06);
  aims.at_most(name + ": rays but primary ones while frames are made", view["occlusion_rays"], 0);
}

}  // namespace

Json square_bench_aims(const Json& results) {
  BenchAims aims;
  const auto each = [&](const char* part, void (*of)(const Json&, BenchAims&)) {
    if (!results.contains(part)) return;
    for (const Json& view : results[part]) of(view, aims);
  };
  each("errors", of_errors);
  if (results.contains("errors")) of_wavelets(results["errors"], aims);
  each("bakes", of_bakes);
  each("speed", of_speed);
  each("edit", of_edit);
  each("storage", of_storage);
  each("rotation", of_rotation);
  each("moving", of_moving);
  return aims.take();
}

}  // namespace sightline
