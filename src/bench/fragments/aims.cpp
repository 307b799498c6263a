#include "bench/fragments/aims.h"

#include <array>
#include <nlohmann/json.hpp>
#include <string>

#include "bench/bench_aims.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

constexpr BenchAims::Shown kPercent = BenchAims::Shown::percent;
constexpr double kL2 = 1e-3, kFlip = 0.02;

struct ViewAims {
  const char* view;
  double equal_error, against_64, equal_time_db;
};
constexpr std::array<ViewAims, 3> kViews = {{{"sponza-court", 2.5, 4.5, 8}, {"conference", 2.5, 4, 6}, {"hairball-room", 1.3, 1.8, 2}}};

void of_curve(const Json& curve, BenchAims& aims) {
  const std::string name = curve["view"].get<std::string>();
  for (const ViewAims& view : kViews) {
    if (name != view.view) continue;
    aims.at_least(name + ": time of Monte Carlo with no more error, over ours", curve["equal_error"]["ratio"], view.equal_error);
    aims.at_least(name + ": time of Monte Carlo with 64 samples, over ours", curve["against_64"], view.against_64);
    aims.at_most(name + ": l2", curve["ours"]["l2"], kL2);
    aims.at_most(name + ": FLIP", curve["ours"]["flip"], kFlip);
    aims.at_least(name + ": dB over Monte Carlo in the same time", curve["equal_time_db"], view.equal_time_db);
  }
}

Json row_of(const Json& table, const char* key) {
  for (const Json& row : table["rows"]) {
    if (row["key"] == key) return row;
  }
  return {};
}

// Null where either is missing.
Json quotient(const Json& a, const Json& b) {
  return a.is_number() && b.is_number() && b.get<double>() > 0 ? Json(a.get<double>() / b.get<double>()) : Json();
}

void of_table(const Json& table, BenchAims& aims) {
  const std::string name = table["view"].get<std::string>();
  const Json ours = row_of(table, "default"), nichols = row_of(table, "nichols");
  if (ours.is_null()) return;
  if (name == "sponza-court") aims.at_most(name + ": pixels at the finest level", ours["level0_share"], 0.4, kPercent);
  if (nichols.is_null()) return;
  aims.at_most(name + ": test rays, of the predecessor's", quotient(ours["test_rays"], nichols["test_rays"]), 1 / 2.5, kPercent);
  aims.at_most(name + ": all rays, of the predecessor's", quotient(ours["rays"], nichols["rays"]), 1 / 1.5, kPercent);
  aims.at_least(name + ": time of the predecessor, over ours", quotient(nichols["seconds"], ours["seconds"]), 1.5);
  // The paper's table: 17 to 80 times.
  aims.at_least(name + ": l2 of the predecessor, over ours", quotient(nichols["l2"], ours["l2"]), 1);
}

}  // namespace

Json fragment_bench_aims(const Json& results) {
  BenchAims aims;
  for (const Json& curve : results["curve"]) of_curve(curve, aims);
  for (const Json& table : results["table"]) of_table(table, aims);
  for (const Json& sizes : results["sizes"])
    aims.at_most(sizes["view"].get<std::string>() + ": largest deviation of l2 from its mean over sizes", sizes["largest_deviation"], 0.5,
                 kPercent);
  for (const Json& path : results["interactive"])
    aims.at_least(path["view"].get<std::string>() + ": frames a second along the path", path["frames_per_second"], 10);
  return aims.take();
}

}  // namespace sightline
