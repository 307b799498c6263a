// The report: charts, tables and the figures' pictures, on one page.
#include "bench/bench_page.h"
#include "bench/square_lights/square_bench.h"
#include "bench/square_lights/tables.h"
#include "report/chart.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

// Figures 9 and 10: error over the number of lights and of wavelets.
std::string error_chart(const Json& view) {
  ChartSeries squares{"squares", {}}, split{"squares, the split alone", {}}, wavelets{"wavelets", {}}, plain{"wavelets, unweighted", {}};
  for (const Json& row : view["rows"]) {
    if (!row["lights"].is_number()) continue;
    const double lights = row["lights"].get<double>(), l2 = 100 * row["l2"].get<double>();
    if (row["basis"] == "squares") {
      squares.points.emplace_back(lights, l2);
      split.points.emplace_back(lights, 100 * row["l2_tables"].get<double>());
    } else {
      (row["basis"] == "haar" ? wavelets : plain).points.emplace_back(lights, l2);
    }
  }
  return line_chart(
      {squares, split, wavelets, plain},
      {.title = view["view"].get<std::string>(), .x_label = "lights or terms", .y_label = "l2, %", .log_x = true, .log_y = true});
}

std::string flip_chart(const Json& views) {
  std::vector<ChartSeries> series;
  for (const Json& view : views) {
    ChartSeries line{view["view"].get<std::string>(), {}};
    for (const Json& row : view["rows"]) line.points.emplace_back(row["frame"].get<double>(), row["flip"].get<double>());
    series.push_back(std::move(line));
  }
  return series.empty() ? "" : line_chart(series, {.title = "Frames beside the reference", .x_label = "frame", .y_label = "mean FLIP"});
}

}  // namespace

std::string square_bench_html(const BenchResults& results) {
  const Json& json = results.json;
  IndexInput page{.title = "Square lights",
                  .text = "Environments as a few squares, beside wavelets, every texel traced, and the reference.",
                  .footer = page_footer(json)};
  const auto add = [&](const char* title, const std::string& figure) {
    if (!figure.empty()) page.sections.push_back({.title = title, .figure = figure});
  };
  const auto tables = [&](const char* part) { return html_tables(square_bench_tables(json, part)); };
  add("Aims", tables("aims"));
  std::string charts;
  for (const Json& view : json["errors"]) charts += error_chart(view);
  add("Errors over the number of lights", charts + tables("errors"));
  add("Bakes", tables("bakes"));
  add("Speed", tables("speed"));
  add("Materials edited", tables("edit"));
  add("Storage", tables("storage"));
  add("The environment turns", tables("rotation"));
  add("Objects move", flip_chart(json["moving"]) + tables("moving") +
                          (results.strip ? strip_figure(*results.strip, "Frames over those of the reference.") : ""));
  add("Beyond the paper, and without parts of it", tables("beyond"));
  if (!results.pictures.empty()) page.sections.push_back(picture_section(results.pictures));
  return index_report(page);
}

}  // namespace sightline
