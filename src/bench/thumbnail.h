// Smaller pictures for pages and strips.
#pragma once

#include "image/image.h"

namespace sightline {

/// Half the size, by means of 2x2 pixels.
ColorImage halved(const ColorImage& image);
/// Halved until it is at most `width_px` wide.
ColorImage thumbnail(ColorImage image, int width_px);

/// Stops of exposure that bring the mean luminance to a fifth: for looking at pictures, not for their metrics.
float viewing_exposure(const ColorImage& image);

}  // namespace sightline
