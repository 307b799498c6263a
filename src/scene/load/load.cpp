#include "scene/load/load.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cctype>
#include <new>
#include <string_view>
#include <system_error>

#include "base/core/error.h"
#include "scene/builtin/builtin.h"

namespace sightline {
namespace {

constexpr std::string_view kBuiltinPrefix = "builtin:";

struct Format {
  std::string_view ending;
  Scene (*load)(const std::filesystem::path& path, const LoadOptions& options, const Context& context);
};

constexpr std::array kFormats = {Format{".gltf", load_gltf}, Format{".glb", load_gltf}, Format{".pbrt", load_pbrt},
                                 Format{".obj", load_obj}, Format{".ply", load_ply}};

std::string lower_case_ending(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending;
}

const Format& format_of(const std::filesystem::path& path) {
  const std::string ending = lower_case_ending(path);
  for (const Format& format : kFormats) {
    if (format.ending == ending) return format;
  }
  throw usage_error(ending.empty() ? "a scene file needs an ending that tells its format"
                                   : fmt::format("'{}' is no known scene format", ending))
      .at(path.string())
      .remedy(fmt::format("known are {} and builtin:NAME", fmt::join(scene_file_endings(), " ")));
}

Scene load_file(const std::filesystem::path& path, const LoadOptions& options, const Context& context) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw input_error("no such file").at(path.string());
  if (std::filesystem::is_directory(status)) throw input_error("is a folder, not a scene file").at(path.string());
  const Format& format = format_of(path);
  try {
    Scene scene = format.load(path, options, context);
    if (scene.name.empty()) scene.name = path.stem().string();
    return scene;
  } catch (const std::bad_alloc&) {
    throw resource_error("not enough memory to read the scene").at(path.string());
  }
}

}  // namespace

std::vector<std::string> scene_file_endings() {
  std::vector<std::string> endings;
  endings.reserve(std::size(kFormats));
  for (const Format& format : kFormats) endings.emplace_back(format.ending);
  return endings;
}

Scene load_scene(const std::string& spec, const LoadOptions& options, const Context& context) {
  if (spec.starts_with(kBuiltinPrefix)) {
    return build_builtin(std::string_view(spec).substr(kBuiltinPrefix.size()), options, context);
  }
  return load_file(spec, options, context);
}

Scene load_scenes(std::span<const std::string> specs, const LoadOptions& options, const Context& context) {
  if (specs.empty()) throw usage_error("no scene is given").remedy("name a scene file or builtin:NAME");
  Scene scene = load_scene(specs.front(), options, context);
  for (const std::string& spec : specs.subspan(1)) {
    context.check_cancelled();
    merge_into(scene, load_scene(spec, options, context));
  }
  return scene;
}

}  // namespace sightline
