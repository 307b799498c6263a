// The benchmark's results as tables, whatever they are written in.
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

/// Tables of one part of the results of run_cache_bench ("aims", "curves", "equal_time", "shadow_maps", "lookup", "flicker", "ablations");
/// empty where it has none.
std::vector<BenchTable> cache_bench_tables(const nlohmann::ordered_json& results, const std::string& part);

std::string markdown_table(const BenchTable& table);
std::string html_table(const BenchTable& table);

}  // namespace sightline
