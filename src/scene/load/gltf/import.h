// What every part of the glTF reader shares while one file becomes one Scene.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>

#include "base/core/context.h"
#include "scene/load/gltf/document.h"
#include "scene/load/warnings.h"
#include "scene/scene.h"

namespace sightline::gltf {

/// The file, the scene it fills, and where to complain.
struct Import {
  Document& document;
  Scene& scene;
  const Context& context;
  std::string name;  ///< the file, for messages

  void warn(std::string_view text) const { add_warning(scene, context, fmt::format("{}: {}", name, text)); }
};

}  // namespace sightline::gltf
