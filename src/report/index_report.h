// A gallery of pictures as one self-contained HTML page: what the demo and the benchmarks leave behind.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "image/image.h"
#include "image/tone_map.h"

namespace sightline {

/// One picture of the gallery.
struct GalleryItem {
  std::string title, caption;
  ColorImage image;
  ToneMap tone_map = ToneMap::srgb;
  float exposure_ev = 0;
  std::string link;                                        ///< a page about this picture, relative to the gallery; may be empty
  std::vector<std::pair<std::string, std::string>> facts;  ///< ("seconds", "1.3"), shown as a small table
};

struct GallerySection {
  std::string title, text;
  std::vector<GalleryItem> items;
  std::string figure;  ///< markup put below the items as it is, such as a chart of chart.h; may be empty
};

struct IndexInput {
  std::string title, text;
  std::vector<GallerySection> sections;
  std::string footer;
};

std::string index_report(const IndexInput& input);

}  // namespace sightline
