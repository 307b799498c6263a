#include "bench/strip.h"

#include <algorithm>
#include <cmath>

#include "bench/thumbnail.h"

namespace sightline {

ColorImage PictureStrip::exposed(ColorImage image, const ColorImage& judged) {
  if (!scale_) scale_ = std::exp2(viewing_exposure(judged));
  for (Color& c : image.pixels) c *= *scale_;
  return image;
}

void PictureStrip::add(const std::vector<ColorImage>& column) {
  std::vector<ColorImage>& small = columns_.emplace_back();
  for (const ColorImage& image : column) small.push_back(halved(image));
}

std::optional<ColorImage> PictureStrip::image() const {
  if (columns_.empty() || columns_[0].empty()) return std::nullopt;
  const int w = columns_[0][0].width, h = columns_[0][0].height, rows = static_cast<int>(columns_[0].size());
  ColorImage strip(w * static_cast<int>(columns_.size()), rows * h);
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    for (int y = 0; y < rows * h; ++y)
      std::copy_n(&columns_[c][static_cast<std::size_t>(y / h)].at(0, y % h), w, &strip.at(static_cast<int>(c) * w, y));
  }
  return strip;
}

}  // namespace sightline
