#include "bench/fragments/maps.h"

#include <fmt/format.h>

#include "bench/thumbnail.h"
#include "image/false_color.h"
#include "image/tone_map.h"

namespace sightline {
namespace {

// Pictures of the page: enough to see shadows by, and some hundred kilobytes each.
constexpr int kPageWidth = 800;
constexpr float kErrorTimes = 9;

}  // namespace

void add_maps(const BuiltView& view, const std::string& name, const RenderRequest& request, const Shot& shot, const FragmentTruth& truth,
              std::vector<BenchPicture>& pictures, const Context& context) {
  const float exposure = viewing_exposure(truth.image);
  const std::string title = view.name + ", " + name;
  pictures.push_back({title, fmt::format("{:.3f} s", shot.seconds), thumbnail(shot.image, kPageWidth), exposure});
  if (request.method == "fragments")
    pictures.push_back({title + ", levels", "from single pixels (black) to squares of 128 (pale)",
                        thumbnail(level_map(view, request, context), kPageWidth), 0.f});
  pictures.push_back({title + ", error", "nine times the difference from the reference, exposed as the picture",
                      thumbnail(error_map(truth, shot.image), kPageWidth), exposure});
}

ColorImage level_map(const BuiltView& view, RenderRequest request, const Context& context) {
  request.settings.emplace_back("show=levels");
  ColorImage image = shoot(view, request, context).image;
  for (Color& color : image.pixels) {
    const Color encoded = false_color(color.x);
    color = {linear_from_srgb(encoded.x), linear_from_srgb(encoded.y), linear_from_srgb(encoded.z)};
  }
  return image;
}

ColorImage error_map(const FragmentTruth& truth, const ColorImage& image) {
  ColorImage error(image.width, image.height);
  for (std::size_t i = 0; i < error.pixels.size(); ++i) {
    if (truth.mask[i] != 0) error.pixels[i] = kErrorTimes * glm::abs(image.pixels[i] - truth.image.pixels[i]);
  }
  return error;
}

}  // namespace sightline
