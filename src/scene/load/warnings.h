// How loaders tell of what they dropped.
#pragma once

#include <string>

#include "base/core/context.h"
#include "scene/scene.h"

namespace sightline {

/// Appends one line to scene.warnings and sends it to the log. After 200 lines one last line says that more were left out, so that a
/// hostile file cannot flood either.
void add_warning(Scene& scene, const Context& context, std::string text);

}  // namespace sightline
