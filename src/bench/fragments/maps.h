// Pictures for the page: what was rendered, where fragments are, where errors are.
#pragma once

#include <string>
#include <vector>

#include "bench/bench_results.h"
#include "bench/fragments/truth.h"

namespace sightline {

/// The picture, its map of levels if the method has one, and nine times its error, as the paper shows them.
void add_maps(const BuiltView& view, const std::string& name, const RenderRequest& request, const Shot& shot, const FragmentTruth& truth,
              std::vector<BenchPicture>& pictures, const Context& context);

/// Levels in false colours: single pixels are black, the coarsest squares pale yellow.
ColorImage level_map(const BuiltView& view, RenderRequest request, const Context& context);

/// 9 |image - truth|; black where pixels do not count.
ColorImage error_map(const FragmentTruth& truth, const ColorImage& image);

}  // namespace sightline
