// pbrt-v4 scene files [Pharr2023]: the two entries.
#include "scene/load/load.h"
#include "scene/load/pbrt/builder.h"
#include "scene/load/pbrt/reader.h"

namespace sightline {

Scene load_pbrt(const std::filesystem::path& path, const LoadOptions&, const Context& context) {
  const std::filesystem::path directory = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  pbrt::Builder builder(directory, context);
  pbrt::Reader reader(builder, directory, context);
  reader.read_file(path);
  reader.finish();
  return builder.finish();
}

Scene parse_pbrt(std::string_view text, const std::string& name, const Context& context) {
  pbrt::Builder builder(std::nullopt, context);
  pbrt::Reader reader(builder, std::nullopt, context);
  reader.read_text(text, name);
  reader.finish();
  Scene scene = builder.finish();
  scene.name = name;
  return scene;
}

}  // namespace sightline
