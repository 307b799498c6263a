// Small charts as SVG text, for benchmark pages and documents.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace sightline {

struct ChartSeries {
  std::string name;
  std::vector<std::pair<double, double>> points;  ///< x, y; drawn in this order; points that are not finite are left out
};

struct ChartOptions {
  std::string title, x_label, y_label;
  bool log_x = false, log_y = false;  ///< logarithmic axes leave out points that are not positive
  int width_px = 640, height_px = 400;
};

/// Lines with markers, axes with round numbers, and a legend if there is more than one series.
std::string line_chart(const std::vector<ChartSeries>& series, const ChartOptions& options);

struct ChartBar {
  std::string name;
  double value = 0;
};
/// Horizontal bars with their values, in the order given; the axis starts at 0.
std::string bar_chart(const std::vector<ChartBar>& bars, const ChartOptions& options);

/// Round positions for the ticks of an axis from `low` to `high`: steps of 1, 2 or 5 times a power of ten, about `count` of them.
std::vector<double> axis_ticks(double low, double high, int count);

}  // namespace sightline
