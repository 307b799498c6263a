#include "report/index_report.h"

#include <fmt/format.h>

#include "image/io/image_io.h"
#include "report/html.h"

namespace sightline {
namespace {

std::string picture_uri(const GalleryItem& item) {
  return data_uri("image/png", encode_png(item.image.width, item.image.height, 3, to_srgb8(item.image, item.tone_map, item.exposure_ev)));
}

std::string card(const GalleryItem& item) {
  std::string html = "<figure class=\"card\">\n";
  if (item.image.width > 0) {
    const std::string picture = fmt::format("<img src=\"{}\" width=\"{}\" height=\"{}\" alt=\"{}\">", picture_uri(item), item.image.width,
                                            item.image.height, escape_html(item.title));
    html += item.link.empty() ? picture : fmt::format("<a href=\"{}\">{}</a>", escape_html(item.link), picture);
  }
  html += "\n<figcaption>\n";
  html += item.link.empty() ? fmt::format("<h3>{}</h3>\n", escape_html(item.title))
                            : fmt::format("<h3><a href=\"{}\">{}</a></h3>\n", escape_html(item.link), escape_html(item.title));
  if (!item.caption.empty()) html += fmt::format("<p>{}</p>\n", escape_html(item.caption));
  if (!item.facts.empty()) {
    html += "<dl>\n";
    for (const auto& [name, value] : item.facts) html += fmt::format("<dt>{}</dt><dd>{}</dd>\n", escape_html(name), escape_html(value));
    html += "</dl>\n";
  }
  return html + "</figcaption>\n</figure>\n";
}

}  // namespace

std::string index_report(const IndexInput& input) {
  std::string page = page_head(input.title);
  page += fmt::format("<body class=\"index\">\n<header><h1>{}</h1><p>{}</p></header>\n", escape_html(input.title), escape_html(input.text));
  for (const GallerySection& section : input.sections) {
    page += "<section class=\"sheet\">\n";
    if (!section.title.empty()) page += fmt::format("<h2>{}</h2>\n", escape_html(section.title));
    if (!section.text.empty()) page += fmt::format("<p>{}</p>\n", escape_html(section.text));
    page += "<div class=\"cards\">\n";
    for (const GalleryItem& item : section.items) page += card(item);
    page += "</div>\n" + section.figure + "</section>\n";
  }
  if (!input.footer.empty()) page += fmt::format("<footer>{}</footer>\n", escape_html(input.footer));
  return page + "</body>\n</html>\n";
}

}  // namespace sightline
