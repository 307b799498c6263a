#include "bench/fragments/row.h"

namespace sightline {

nlohmann::ordered_json fragment_row(const FragmentTruth& truth, const Shot& shot) {
  using Json = nlohmann::ordered_json;
  Json row = {{"seconds", shot.seconds}};
  for (const char* name :
       {"fragments", "level0_fragments", "test_rays", "confirmation_rays", "level0_rays", "extra_samples", "extra_rays"}) {
    const auto found = shot.statistics.method_statistics.find(name);
    row[name] = found != shot.statistics.method_statistics.end() ? Json(found->second) : Json();
  }
  const auto pixels = static_cast<double>(shot.image.pixels.size());
  row["level0_share"] = row["level0_fragments"].is_number() ? Json(row["level0_fragments"].get<double>() / pixels) : Json();
  row["rays"] = shot.statistics.rays.occlusion;
  row["stages"] = Json::object();
  for (const auto& [stage, seconds] : shot.statistics.stage_seconds) row["stages"][stage] = seconds;
  row.update(fragment_errors(truth, shot.image));
  return row;
}

}  // namespace sightline
