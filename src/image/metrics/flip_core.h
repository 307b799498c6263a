// What LDR- and HDR-FLIP share.
#pragma once

#include "image/image.h"

namespace sightline {

/// FLIP's error map of two pictures of linear display light, 0..1 [Andersson2020]; 0..1 a pixel.
std::vector<float> flip_of_display_light(const ColorImage& reference, const ColorImage& image, float pixels_per_degree);

}  // namespace sightline
