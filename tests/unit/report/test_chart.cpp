#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "report/chart.h"

namespace sightline {
namespace {

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++count;
  return count;
}

TEST(Chart, TicksAreRoundAndInside) {
  EXPECT_EQ(axis_ticks(0, 10, 5), (std::vector<double>{0, 2, 4, 6, 8, 10}));
  const std::vector<double> fine = axis_ticks(0.13, 0.47, 6);
  ASSERT_FALSE(fine.empty());
  for (const double tick : fine) {
    EXPECT_GE(tick, 0.13 - 1e-12);
    EXPECT_LE(tick, 0.47 + 1e-12);
    EXPECT_NEAR(tick / 0.05, std::round(tick / 0.05), 1e-9);
  }
}

TEST(Chart, TicksOfNoRangeAreOnePoint) {
  EXPECT_EQ(axis_ticks(3, 3, 5).size(), 1u);
  EXPECT_EQ(axis_ticks(0, std::numeric_limits<double>::infinity(), 5).size(), 1u);
}

TEST(Chart, EveryDrawablePointHasAMarker) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const ChartSeries series{"a", {{1, 10}, {2, nan}, {3, 0}, {4, 1000}}};
  EXPECT_EQ(count_of(line_chart({series}, {.title = "t"}), "<circle"), 3u);
  EXPECT_EQ(count_of(line_chart({series}, {.title = "t", .log_y = true}), "<circle"), 2u);
}

TEST(Chart, NothingToDrawIsStillAChart) {
  for (const bool logarithmic : {false, true}) {
    const std::string svg = line_chart({}, {.log_x = logarithmic, .log_y = logarithmic});
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("inf"), std::string::npos);
    EXPECT_NE(svg.find("</svg>"), std::string::npos);
  }
  EXPECT_EQ(bar_chart({}, {}).find("nan"), std::string::npos);
}

TEST(Chart, BarsAreAsLongAsTheirValues) {
  const std::string svg = bar_chart({{"half", 5}, {"whole", 10}, {"none", 0}}, {.width_px = 500});
  std::vector<double> widths;
  for (std::size_t at = svg.find("<rect"); at != std::string::npos; at = svg.find("<rect", at + 1))
    widths.push_back(std::stod(svg.substr(svg.find("width=\"", at) + 7)));
  ASSERT_EQ(widths.size(), 3u);
  EXPECT_NEAR(widths[0], widths[1] / 2, 0.2);
  EXPECT_EQ(widths[2], 0);
}

TEST(Chart, LabelsAreEscaped) { EXPECT_EQ(bar_chart({{"<x>", 1}}, {.title = "a<b"}).find("<x>"), std::string::npos); }

}  // namespace
}  // namespace sightline
