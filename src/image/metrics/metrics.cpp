#include "image/metrics/metrics.h"

#include <algorithm>
#include <numeric>

#include "base/core/error.h"
#include "image/metrics/metric_functions.h"

namespace sightline {
namespace {

/// Number of letters to insert, delete or change [Levenshtein1966].
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = std::exchange(row[j], std::min({changed, row[j] + 1, row[j - 1] + 1}));
    }
  }
  return row.back();
}

}  // namespace

const std::vector<Metric>& metrics() {
  static const std::vector<Metric> table = {
      {"mse", "mean (I - R)^2", false, compute_mse},
      {"rmse", "sqrt(mean (I - R)^2)", false, compute_rmse},
      {"relmse", "mean (I - R)^2 / (R^2 + 0.01)", false, compute_relmse},
      {"nmse", "sum (I - R)^2 / sum R", false, compute_nmse},
      {"l2", "sum (I - R)^2 / sum R^2", false, compute_l2},
      {"linf", "sum |I - R| / sum R", false, compute_linf},
      {"psnr", "-10 log10(mean (I - R)^2) of sRGB values 0..1, in dB", true, compute_psnr},
      {"ssim", "structural similarity of the sRGB luma, Gaussian 11x11 window", true, compute_ssim},
      {"flip", "mean LDR-FLIP error after exposure and sRGB", false, compute_flip},
      {"hdrflip", "mean HDR-FLIP error with automatic exposures", false, compute_hdrflip},
  };
  return table;
}

const Metric& find_metric(std::string_view name) {
  const std::vector<Metric>& table = metrics();
  const auto distance = [name](const Metric& metric) { return edit_distance(name, metric.name); };
  const auto nearest =
      std::min_element(table.begin(), table.end(), [&](const Metric& a, const Metric& b) { return distance(a) < distance(b); });
  if (nearest->name == name) return *nearest;
  throw usage_error("unknown metric '" + std::string(name.substr(0, 100)) + "'").remedy("did you mean '" + nearest->name + "'?");
}

}  // namespace sightline
