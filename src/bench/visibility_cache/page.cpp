// The report: the paper's charts, tables, pictures, on one page.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "bench/bench_page.h"
#include "bench/visibility_cache/cache_bench.h"
#include "bench/visibility_cache/tables.h"
#include "report/chart.h"
#include "report/index_report.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

struct Curve {
  const char *key, *title, *label;
  bool log_y;
  double scale;
};
constexpr std::array<Curve, 4> kCurves = {{{"ray_reduction", "Ray reduction", "hits / misses", true, 1},
                                           {"speed_up", "Speed-up", "time exact / time cached", false, 1},
                                           {"linf", "L^INF", "%", false, 100},
                                           {"flip", "FLIP", "mean FLIP", false, 1}}};

// The four charts of one number of samples a pixel, a line a view.
std::string charts(const Json& views, const Json& spp) {
  std::string svg;
  for (const Curve& curve : kCurves) {
    std::vector<ChartSeries> series;
    for (const Json& view : views) {
      for (const Json& sample : view["samples"]) {
        if (sample["spp"] != spp) continue;
        ChartSeries line{view["view"].get<std::string>(), {}};
        for (const Json& row : sample["cached"]) {
          const Json& value = row[curve.key];
          line.points.emplace_back(row["ce"].get<double>(), value.is_number() ? curve.scale * value.get<double>() : std::nan(""));
        }
        series.push_back(std::move(line));
      }
    }
    svg += line_chart(series, {.title = curve.title, .x_label = "C_E", .y_label = curve.label, .log_x = true, .log_y = curve.log_y});
  }
  return svg;
}

std::vector<Json> sample_counts(const Json& views) {
  std::vector<Json> counts;
  for (const Json& view : views) {
    for (const Json& sample : view["samples"]) {
      if (std::find(counts.begin(), counts.end(), sample["spp"]) == counts.end()) counts.push_back(sample["spp"]);
    }
  }
  return counts;
}

std::string tables(const Json& results, const std::string& part) { return html_tables(cache_bench_tables(results, part)); }

std::string error_bars(const Json& rows, const std::string& title) {
  std::vector<ChartBar> bars;
  for (const Json& row : rows) bars.push_back({row["name"].get<std::string>(), row["flip"].is_number() ? row["flip"].get<double>() : 0});
  return bar_chart(bars, {.title = title, .x_label = "mean FLIP"});
}

}  // namespace

std::string cache_bench_html(const BenchResults& results) {
  const Json& json = results.json;
  IndexInput page{.title = "Visibility cache",
                  .text = "One shadow ray for many queries, beside exact rays, shadow maps and NEE++.",
                  .footer = page_footer(json)};
  for (const Json& spp : sample_counts(json["curves"]))
    page.sections.push_back({.title = fmt::format("Against C_E, {} sample{} a pixel", spp.get<int>(), spp == 1 ? "" : "s"),
                             .figure = charts(json["curves"], spp)});
  const auto add = [&](const char* title, const std::string& figure) {
    if (!figure.empty()) page.sections.push_back({.title = title, .figure = figure});
  };
  add("Aims", tables(json, "aims"));
  add("Figures", tables(json, "curves"));
  std::string bars;
  for (const Json& view : json["equal_time"]) bars += error_bars(view["rows"], "Equal time: " + view["view"].get<std::string>());
  add("In equal time", bars + tables(json, "equal_time"));
  bars.clear();
  for (const Json& view : json["shadow_maps"]) {
    for (const Json& sample : view["samples"])
      bars += error_bars(sample["rows"], fmt::format("{}, {} spp", view["view"].get<std::string>(), sample["spp"].get<int>()));
  }
  add("Shadow maps", bars + tables(json, "shadow_maps"));
  add("Cost of a look-up", tables(json, "lookup"));
  add("Camera move",
      tables(json, "flicker") +
          (results.strip ? strip_figure(*results.strip, "Frames, from the top: cached, exact, difference (yellow: half of the mean).")
                         : ""));
  add("Ablations", tables(json, "ablations"));
  if (!results.pictures.empty()) page.sections.push_back(picture_section(results.pictures));
  return index_report(page);
}

}  // namespace sightline
