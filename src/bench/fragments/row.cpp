#include "bench/fragments/row.h"

namespace sightline {

nlohmann::ordered_json fragment_row(const FragmentTruth& truth, const Shot& shot) {
  using Json = nlohmann::ordered_json;
  const auto& counted = shot.statistics.method_statistics;
  const auto statistic = [&](const char* name) {
    const auto found = counted.find(name);
    return found != counted.end() ? Json(found->second) : Json();
  };
  Json row = {{"seconds", shot.seconds}};
  for (const char* name : {"fragments", "level0_fragments", "extra_samples"}) row[name] = statistic(name);
  // What no purpose is counted for is there as well, so that the sum is right.
  auto other = static_cast<double>(shot.statistics.rays.occlusion);
  for (const char* name : {"test_rays", "confirmation_rays", "level0_rays", "extra_rays", "penumbra_rays"}) {
    row[name] = statistic(name);
    if (row[name].is_number()) other -= row[name].get<double>();
  }
  row["other_rays"] = row["fragments"].is_number() ? Json(other) : Json();
  const auto pixels = static_cast<double>(shot.image.pixels.size());
  row["level0_share"] = row["level0_fragments"].is_number() ? Json(row["level0_fragments"].get<double>() / pixels) : Json();
  row["rays"] = shot.statistics.rays.occlusion;
  row["stages"] = Json::object();
  for (const auto& [stage, seconds] : shot.statistics.stage_seconds) row["stages"][stage] = seconds;
  row.update(fragment_errors(truth, shot.image));
  return row;
}

}  // namespace sightline
