// Which extensions a file uses, and what that means for reading it.
#pragma once

#include "scene/load/gltf/import.h"

namespace sightline::gltf {

/// Throws where a required extension changes the geometry in a way that is not supported; one warning lists all others that are not.
void check_extensions(Import& import);

}  // namespace sightline::gltf
