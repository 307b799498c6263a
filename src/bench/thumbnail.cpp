#include "bench/thumbnail.h"

#include <algorithm>
#include <cmath>

namespace sightline {

ColorImage halved(const ColorImage& image) {
  ColorImage half(std::max(1, image.width / 2), std::max(1, image.height / 2));
  for (int y = 0; y < half.height; ++y) {
    for (int x = 0; x < half.width; ++x) {
      Color sum(0);
      for (int k = 0; k < 4; ++k) sum += image.at(std::min(2 * x + k % 2, image.width - 1), std::min(2 * y + k / 2, image.height - 1));
      half.at(x, y) = 0.25f * sum;
    }
  }
  return half;
}

ColorImage thumbnail(ColorImage image, int width_px) {
  while (image.width > std::max(1, width_px)) image = halved(image);
  return image;
}

float viewing_exposure(const ColorImage& image) {
  double sum = 0;
  for (const Color& c : image.pixels) {
    const double y = 0.2126 * static_cast<double>(c.x) + 0.7152 * static_cast<double>(c.y) + 0.0722 * static_cast<double>(c.z);
    // One lamp in view must not darken everything else.
    if (std::isfinite(y)) sum += std::min(y, 10.0);
  }
  if (!(sum > 0)) return 0;
  return static_cast<float>(std::clamp(std::log2(0.2 * static_cast<double>(image.pixels.size()) / sum), -16.0, 16.0));
}

}  // namespace sightline
