// Reference pictures: expensive, and therefore kept where a folder is given.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "bench/bench_shot.h"
#include "bench/fragments/fragment_bench.h"

namespace sightline {

struct FragmentTruth {
  ColorImage image;
  std::vector<std::uint8_t> mask;  ///< pixels that count
  int samples = 0;
};

/// Monte Carlo with the options' number of shadow rays a pixel, from the options' folder if it is there.
FragmentTruth fragment_truth(const BuiltView& view, const FragmentBenchOptions& options, const Context& context);

/// Name of the file that the picture is kept in: by view, size, samples, and a hash of scene and camera.
std::string truth_file_name(const BuiltView& view, int samples);

/// l2, nmse, flip and psnr against the truth.
nlohmann::ordered_json fragment_errors(const FragmentTruth& truth, const ColorImage& image);

}  // namespace sightline
