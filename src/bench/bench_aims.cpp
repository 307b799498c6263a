#include "bench/bench_aims.h"

namespace sightline {

using Json = nlohmann::ordered_json;

void BenchAims::at_most(const std::string& figure, const Json& measured, double aim, Shown shown) {
  add(figure, measured, aim, true, shown);
}
void BenchAims::at_least(const std::string& figure, const Json& measured, double aim, Shown shown) {
  add(figure, measured, aim, false, shown);
}

void BenchAims::add(const std::string& figure, const Json& measured, double aim, bool at_most, Shown shown) {
  if (!measured.is_number()) return;
  const double value = measured.get<double>();
  rows_.push_back({{"figure", figure},
                   {"measured", value},
                   {"aim", aim},
                   {"at_most", at_most},
                   {"percent", shown == Shown::percent},
                   {"met", at_most ? value <= aim : value >= aim}});
}

}  // namespace sightline
