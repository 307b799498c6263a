// Pictures of a sequence side by side.
#pragma once

#include <optional>
#include <vector>

#include "image/image.h"

namespace sightline {

/// A column for each frame that is shown, of as many pictures as the others have, at half their size.
class PictureStrip {
 public:
  /// `image` exposed for looking at, as the first `judged` asks for: all frames alike.
  ColorImage exposed(ColorImage image, const ColorImage& judged);
  /// From top to bottom.
  void add(const std::vector<ColorImage>& column);
  /// Nothing where no column was added.
  std::optional<ColorImage> image() const;

 private:
  std::vector<std::vector<ColorImage>> columns_;
  std::optional<float> scale_;
};

}  // namespace sightline
