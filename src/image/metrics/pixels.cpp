#include "image/metrics/pixels.h"

#include <algorithm>

#include "base/core/error.h"

namespace sightline {

void check_comparable(const ColorImage& reference, const ColorImage& image, const MetricOptions& options) {
  const auto size = [](const ColorImage& picture) { return std::to_string(picture.width) + "x" + std::to_string(picture.height); };
  if (reference.width != image.width || reference.height != image.height || reference.pixels.size() != image.pixels.size())
    throw usage_error("pictures of " + size(reference) + " and " + size(image) + " pixels cannot be compared");
  if (!options.mask.empty() && options.mask.size() != reference.pixels.size())
    throw usage_error("the mask has another size than the pictures");
  const bool any = options.mask.empty() ? !reference.pixels.empty()
                                        : std::any_of(options.mask.begin(), options.mask.end(), [](std::uint8_t m) { return m != 0; });
  if (!any) throw usage_error("no pixel is left to compare");
}

double mean_counted(const std::vector<float>& map, const MetricOptions& options) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (!counts(options, i)) continue;
    sum += map[i];
    ++count;
  }
  return sum / static_cast<double>(count);
}

ColorImage with_reference_outside_mask(const ColorImage& reference, const ColorImage& image, const MetricOptions& options) {
  ColorImage result = image;
  for (std::size_t i = 0; i < result.pixels.size(); ++i) {
    if (!counts(options, i)) result.pixels[i] = reference.pixels[i];
  }
  return result;
}

}  // namespace sightline
