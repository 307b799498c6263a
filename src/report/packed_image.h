// High dynamic range pictures small enough to put into a web page.
#pragma once

#include <string>

#include "image/image.h"

namespace sightline {

/// A picture as half floats, predicted from the left neighbour, split into byte planes, deflated, in base64: about a third of plain half
/// floats for smooth pictures, and exact but for the rounding to half (relative 2^-11). assets/decode.js undoes it.
struct PackedImage {
  int width = 0, height = 0;
  std::string base64;
  double mean_luminance = 0;  ///< of the rounded finite values; the page recomputes it to prove that it decoded the same picture
};

/// Values beyond the range of half become its largest finite value; NaN and infinity stay, so that the page can show them.
PackedImage pack_image(const ColorImage& image);

}  // namespace sightline
