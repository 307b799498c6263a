#include <fmt/format.h>

#include <array>
#include <string_view>
#include <system_error>

#include "base/core/error.h"
#include "image/io/image_io.h"
#include "scene/load/load.h"
#include "scene/load/warnings.h"

namespace sightline {
namespace {

constexpr std::array<std::string_view, 14> kImageEndings = {".png", ".jpg", ".jpeg", ".tga", ".exr", ".hdr",  ".pfm",
                                                            ".bmp", ".PNG", ".JPG",  ".TGA", ".EXR", ".JPEG", ".BMP"};

bool is_file(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

/// The file itself, else one of the same stem with another ending; empty if there is none.
std::filesystem::path find_image_file(const std::filesystem::path& path) {
  if (is_file(path)) return path;
  for (const std::string_view ending : kImageEndings) {
    std::filesystem::path candidate = path;
    candidate.replace_extension(ending);
    if (candidate != path && is_file(candidate)) return candidate;
  }
  return {};
}

}  // namespace

std::shared_ptr<const Image> load_texture_image(const std::filesystem::path& path, Scene& scene, const Context& context) {
  const std::filesystem::path found = find_image_file(path);
  if (found.empty()) {
    add_warning(scene, context, fmt::format("{}: image not found, nor one with another ending", path.string()));
    return nullptr;
  }
  if (found != path) {
    add_warning(scene, context, fmt::format("{}: image not found, {} is used instead", path.string(), found.filename().string()));
  }
  try {
    return std::make_shared<const Image>(read_image(found));
  } catch (const Error& error) {
    if (error.code() == ErrorCode::interrupted) throw;
    add_warning(scene, context, fmt::format("{} (the image is left out)", error.what()));
    return nullptr;
  }
}

}  // namespace sightline
