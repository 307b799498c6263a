// What a benchmark suite leaves behind.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "image/image.h"

namespace sightline {

struct BenchPicture {
  std::string title, caption;
  ColorImage image;
  std::optional<float> exposure_ev;  ///< for looking at it; without one, that of the picture before
};

struct BenchResults {
  nlohmann::ordered_json json;
  std::vector<BenchPicture> pictures;
  std::optional<ColorImage> strip;  ///< frames of a camera move
};

}  // namespace sightline
