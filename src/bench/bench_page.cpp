#include "bench/bench_page.h"

#include <fmt/format.h>

#include "image/io/image_io.h"
#include "image/tone_map.h"
#include "report/html.h"

namespace sightline {

std::string page_footer(const nlohmann::ordered_json& results) {
  return fmt::format("Sightline {}, {} threads, {}{}", results["sightline"].get<std::string>(), results["threads"].get<int>(),
                     results["simd"].get<std::string>(), results["quick"].get<bool>() ? ", quick: not to be quoted" : "");
}

GallerySection picture_section(const std::vector<BenchPicture>& pictures) {
  GallerySection section{.title = "Pictures", .text = "Exposed for looking at; errors are taken without."};
  float exposure = 0;
  for (const BenchPicture& picture : pictures) {
    exposure = picture.exposure_ev.value_or(exposure);
    section.items.push_back({.title = picture.title, .caption = picture.caption, .image = picture.image, .exposure_ev = exposure});
  }
  return section;
}

std::string strip_figure(const ColorImage& strip, const std::string& text) {
  const std::vector<std::byte> png = encode_png(strip.width, strip.height, 3, to_srgb8(strip));
  return fmt::format("<p>{}</p>\n<img src=\"{}\" width=\"{}\" height=\"{}\" alt=\"frames of the camera move\">\n", escape_html(text),
                     data_uri("image/png", png), strip.width, strip.height);
}

}  // namespace sightline
