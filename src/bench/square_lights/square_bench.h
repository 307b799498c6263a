// `sightline bench square-lights`: squares of light beside wavelets, traced light and the reference; what bakes and frames cost.
#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bake/bake_store.h"
#include "base/core/context.h"
#include "base/math/vec.h"
#include "bench/bench_results.h"

namespace sightline {

struct SquareBenchOptions {
  std::filesystem::path data;            ///< see load_bench_view
  std::filesystem::path bake_directory;  ///< where bakes are kept between runs; empty = in memory alone
  std::vector<std::string> views;        ///< instead of each part's own
  std::vector<std::string> parts;        ///< of square_bench_parts(); empty = all
  std::optional<IVec2> size_px;          ///< instead of the views' own 800x600
  int truth_samples = 0;                 ///< light samples a pixel of the reference; 0 = 4096
  bool strip = false;                    ///< the caller wants the strip of the results
  bool quick = false;                    ///< small pictures, coarse cube maps, tables and grounds: not to be quoted
};

/// errors, bakes, speed, edit, storage, rotation, moving, beyond, pictures.
std::vector<std::string> square_bench_parts();

/// Measures in this process. Views whose files are missing are left out with a warning. When cancelled, what is complete by then is
/// returned, with "interrupted": true.
BenchResults run_square_bench(const SquareBenchOptions& options, const Context& context);
/// The results as Markdown tables.
std::string square_bench_markdown(const nlohmann::ordered_json& results);
/// One page with tables, charts and pictures that needs no other file.
std::string square_bench_html(const BenchResults& results);

}  // namespace sightline
