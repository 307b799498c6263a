#include "scene/load/gltf/extensions.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <set>

#include "base/core/error.h"

namespace sightline::gltf {
namespace {

constexpr std::array<std::string_view, 5> kSupported = {"KHR_lights_punctual", "KHR_materials_emissive_strength", "KHR_texture_transform",
                                                        "KHR_mesh_quantization", "EXT_mesh_gpu_instancing"};
/// Without these there is no geometry to show.
constexpr std::array<std::string_view, 3> kGeometry = {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"};

template <std::size_t N>
bool contains(const std::array<std::string_view, N>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

void check_extensions(Import& import) {
  const JsonView root = import.document.root();
  std::set<std::string> others;
  if (const std::optional<JsonView> required = root.find("extensionsRequired")) {
    for (std::size_t i = 0; i < required->size(); ++i) {
      const JsonView name = required->at(i);
      if (contains(kGeometry, name.as_string())) {
        throw input_error(fmt::format("the file requires the extension {}, which is not supported", name.as_string()))
            .at(name.path())
            .remedy("save the model without mesh compression");
      }
      if (!contains(kSupported, name.as_string())) others.insert(name.as_string());
    }
  }
  if (const std::optional<JsonView> used = root.find("extensionsUsed")) {
    for (std::size_t i = 0; i < used->size(); ++i) {
      const JsonView name = used->at(i);
      if (!contains(kSupported, name.as_string())) others.insert(name.as_string());
    }
  }
  if (others.empty()) return;
  constexpr std::size_t kMaxListed = 40;
  const auto end = std::next(others.begin(), static_cast<std::ptrdiff_t>(std::min(others.size(), kMaxListed)));
  import.warn(
      fmt::format("extensions that are not honoured: {}{}", fmt::join(others.begin(), end, ", "), end == others.end() ? "" : ", ..."));
}

}  // namespace sightline::gltf
