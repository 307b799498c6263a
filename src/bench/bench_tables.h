// The benchmarks' results as tables, whatever they are written in.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace sightline {

struct BenchTable {
  std::string title, note;
  std::vector<std::string> header;
  std::size_t text_columns = 1;  ///< the first ones; the others are numbers, to the right
  std::vector<std::vector<std::string>> rows;
};

std::string markdown_table(const BenchTable& table);
std::string html_table(const BenchTable& table);
std::string html_tables(const std::vector<BenchTable>& tables);

/// What BenchAims made of a run, a row an aim.
BenchTable aims_table(const nlohmann::ordered_json& aims);

/// Values of the results as cells. JSON has no infinity and no NaN: what is no number is a dash.
namespace cell {

double number(const nlohmann::ordered_json& json);  ///< NaN where it is none
std::string fixed(const nlohmann::ordered_json& json, int digits);
std::string scientific(const nlohmann::ordered_json& json);  ///< "1.23e-04"
std::string count(const nlohmann::ordered_json& json);       ///< whole, thousands apart: "1 228 800"
std::string percent(const nlohmann::ordered_json& json, int digits = 2);
std::string signed_percent(const nlohmann::ordered_json& json);
std::string seconds(const nlohmann::ordered_json& json);  ///< milliseconds where it is less than one
std::string text(const nlohmann::ordered_json& json);     ///< strings as they are, other values as JSON
std::string size(const nlohmann::ordered_json& json);     ///< [w, h] as "WxH"

}  // namespace cell

}  // namespace sightline
