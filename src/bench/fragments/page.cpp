// The report: charts, tables, pictures with their fragment and error maps, on one page.
#include "bench/bench_page.h"
#include "bench/fragments/fragment_bench.h"
#include "bench/fragments/tables.h"
#include "report/chart.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

// Error over time: Monte Carlo's line, and points for what the table has.
std::string error_chart(const Json& curve, const Json& tables) {
  ChartSeries monte_carlo{"Monte Carlo", {}};
  for (const Json& row : curve["rows"]) monte_carlo.points.emplace_back(row["seconds"].get<double>(), row["l2"].get<double>());
  const Json& ours = curve["ours"];
  std::vector<ChartSeries> series = {std::move(monte_carlo), {"fragments", {{ours["seconds"].get<double>(), ours["l2"].get<double>()}}}};
  for (const Json& table : tables) {
    if (table["view"] != curve["view"]) continue;
    for (const Json& row : table["rows"]) {
      if (row["key"] == "koa" || row["key"] == "nichols")
        series.push_back({row["name"].get<std::string>(), {{row["seconds"].get<double>(), row["l2"].get<double>()}}});
    }
  }
  return line_chart(
      series, {.title = curve["view"].get<std::string>(), .x_label = "seconds a frame", .y_label = "l2", .log_x = true, .log_y = true});
}

std::string size_chart(const Json& sizes) {
  ChartSeries line{"l2", {}};
  for (const Json& row : sizes["rows"]) line.points.emplace_back(row["side"].get<double>(), row["l2"].get<double>());
  return line_chart({line}, {.title = sizes["view"].get<std::string>(), .x_label = "side of the light", .y_label = "l2"});
}

}  // namespace

std::string fragment_bench_html(const BenchResults& results) {
  const Json& json = results.json;
  IndexInput page{.title = "Fragments",
                  .text = "Shadow rays for squares of pixels, beside the methods before it and Monte Carlo.",
                  .footer = page_footer(json)};
  const auto add = [&](const char* title, const std::string& figure) {
    if (!figure.empty()) page.sections.push_back({.title = title, .figure = figure});
  };
  const auto tables = [&](const char* part) { return html_tables(fragment_bench_tables(json, part)); };
  add("Aims", tables("aims"));
  std::string charts;
  for (const Json& curve : json["curve"]) charts += error_chart(curve, json["table"]);
  add("Error over time", charts + tables("curve"));
  add("Fragments, rays, errors", tables("table"));
  charts.clear();
  for (const Json& sizes : json["sizes"]) charts += size_chart(sizes);
  add("Sizes of the light", charts + tables("sizes"));
  add("Camera and light moving",
      tables("interactive") + (results.strip ? strip_figure(*results.strip, "Frames over their maps of fragments.") : ""));
  add("Camera moving, light at rest", tables("temporal"));
  if (!results.pictures.empty()) page.sections.push_back(picture_section(results.pictures));
  return index_report(page);
}

}  // namespace sightline
