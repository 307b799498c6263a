#include "bench/bench_tables.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "report/html.h"

namespace sightline {

using Json = nlohmann::ordered_json;

namespace cell {

double number(const Json& json) { return json.is_number() ? json.get<double>() : std::nan(""); }

std::string fixed(const Json& json, int digits) {
  const double value = number(json);
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "–";
}

std::string scientific(const Json& json) {
  const double value = number(json);
  return std::isfinite(value) ? fmt::format("{:.2e}", value) : "–";
}

std::string count(const Json& json) {
  std::string digits = fixed(json, 0);
  // No-break spaces, so that a number stays in one line.
  for (auto at = static_cast<std::ptrdiff_t>(digits.size()) - 3; at > 0 && digits != "–"; at -= 3)
    digits.insert(static_cast<std::size_t>(at), "\u00a0");
  return digits;
}

std::string percent(const Json& json, int digits) {
  const double value = number(json);
  return std::isfinite(value) ? fmt::format("{:.{}f} %", 100 * value, digits) : "–";
}

std::string signed_percent(const Json& json) {
  const double value = number(json);
  return std::isfinite(value) ? fmt::format("{:+.2f} %", 100 * value) : "–";
}

std::string seconds(const Json& json) { return fixed(json, number(json) < 1 ? 3 : 2); }
std::string text(const Json& json) { return json.is_string() ? json.get<std::string>() : json.dump(); }
std::string size(const Json& json) { return fmt::format("{}x{}", json[0].get<int>(), json[1].get<int>()); }

}  // namespace cell

namespace {

// As many digits as tell a figure from its aim.
std::string number_of_any_size(const Json& value) {
  const double size = std::abs(cell::number(value));
  return size > 0 && size < 1e-3 ? cell::scientific(value) : cell::fixed(value, size < 1 ? 4 : 2);
}

}  // namespace

BenchTable aims_table(const Json& aims) {
  BenchTable table{.title = "Aims",
                   .note = "For pictures of the views' own size; small pictures have more edges and fewer pixels to share.",
                   .header = {"figure", "measured", "aim", "met"}};
  for (const Json& row : aims) {
    const bool is_share = row["percent"].get<bool>();
    const auto shown = [&](const Json& value) { return is_share ? cell::percent(value) : number_of_any_size(value); };
    table.rows.push_back({cell::text(row["figure"]), shown(row["measured"]),
                          (row["at_most"].get<bool>() ? "at most " : "at least ") + shown(row["aim"]),
                          row["met"].get<bool>() ? "yes" : "no"});
  }
  return table;
}

std::string markdown_table(const BenchTable& table) {
  std::string text = fmt::format("### {}\n\n{}\n\n|", table.title, table.note);
  for (const std::string& header : table.header) text += " " + header + " |";
  text += "\n|";
  for (std::size_t i = 0; i < table.header.size(); ++i) text += i < table.text_columns ? "---|" : "---:|";
  text += "\n";
  for (const auto& row : table.rows) {
    text += "|";
    for (const std::string& value : row) text += " " + value + " |";
    text += "\n";
  }
  return text + "\n";
}

std::string html_table(const BenchTable& table) {
  std::string html = fmt::format("<h3>{}</h3>\n<p>{}</p>\n<table>\n<tr>", escape_html(table.title), escape_html(table.note));
  for (const std::string& header : table.header) html += fmt::format("<th>{}</th>", escape_html(header));
  html += "</tr>\n";
  for (const auto& row : table.rows) {
    html += "<tr>";
    for (const std::string& value : row) html += fmt::format("<td>{}</td>", escape_html(value));
    html += "</tr>\n";
  }
  return html + "</table>\n";
}

std::string html_tables(const std::vector<BenchTable>& tables) {
  std::string html;
  for (const BenchTable& table : tables) html += html_table(table);
  return html;
}

}  // namespace sightline
