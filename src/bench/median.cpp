#include "bench/median.h"

#include <algorithm>

namespace sightline {

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

}  // namespace sightline
