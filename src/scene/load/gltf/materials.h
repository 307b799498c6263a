// glTF materials: metallic-roughness and the extensions that are honoured.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/load/gltf/import.h"
#include "scene/load/gltf/textures.h"

namespace sightline::gltf {

/// Fills scene.materials, one for each of the file, in its order. Returns the texture coordinate set that each of them uses.
std::vector<std::uint64_t> import_materials(Import& import, TextureImporter& textures);

}  // namespace sightline::gltf
