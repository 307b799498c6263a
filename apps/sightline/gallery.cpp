// sightline gallery
#include <filesystem>

#include "commands.h"
#include "image/io/image_io.h"
#include "image/tone_map.h"
#include "report/index_report.h"
#include "report/picture_facts.h"
#include "sightline/version.h"

namespace sightline::app {
namespace {

GalleryItem load_item(const std::filesystem::path& path, const std::filesystem::path& page) {
  const LayeredImage layers = read_layered_image(path);
  GalleryItem item{.title = path.stem().string(), .image = color_of(layers)};
  for (const auto& [key, value] : layers.metadata) {
    if (key == "sightline.statistics") item.facts = picture_facts(value);
    if (key == "sightline.command") item.caption = value;
  }
  // A report on the picture lies beside it under the same name.
  const std::filesystem::path report = std::filesystem::path(path).replace_extension(".html");
  std::error_code ignored;
  if (std::filesystem::exists(report, ignored) && !std::filesystem::equivalent(report, page, ignored)) {
    const std::filesystem::path base = std::filesystem::absolute(page).parent_path();
    item.link = std::filesystem::proximate(std::filesystem::absolute(report), base, ignored).generic_string();
  }
  return item;
}

}  // namespace

int run_gallery(const CommandLine& line) {
  const GalleryCommand& command = line.gallery;
  check_writable(command.output);
  const ToneMap tone_map = tone_map_from_name(command.tonemap);
  IndexInput input{.title = command.title, .footer = std::string("Sightline ") + kVersion};
  GallerySection& section = input.sections.emplace_back();
  for (const std::string& picture : command.pictures) {
    GalleryItem item = load_item(picture, command.output);
    item.tone_map = tone_map;
    item.exposure_ev = command.exposure_ev;
    section.items.push_back(std::move(item));
  }
  write_text(command.output, index_report(input));
  return kDone;
}

}  // namespace sightline::app
