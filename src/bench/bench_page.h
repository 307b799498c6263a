// What the benchmarks' pages share.
#pragma once

#include <string>
#include <vector>

#include "bench/bench_results.h"
#include "report/index_report.h"

namespace sightline {

/// Version, threads and instruction set, as results of every suite state them.
std::string page_footer(const nlohmann::ordered_json& results);
/// Pictures exposed for looking at.
GallerySection picture_section(const std::vector<BenchPicture>& pictures);
/// Frames of a camera move under a sentence that says what they are.
std::string strip_figure(const ColorImage& strip, const std::string& text);

}  // namespace sightline
